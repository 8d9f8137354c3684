/// PLY 1.0 (Turk 1994, "The PLY Polygon File Format"): text and binary of both byte orders. The `vertex`
/// element becomes the cloud; PCL's `camera` element gives its rows, columns and sensor pose; the rest is
/// skipped.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "cloud/cloud_formats.hpp"
#include "cloud/columns.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/text_scan.hpp"

namespace tubebin::cloud {
namespace {

struct Property {
  std::string_view name;
  ScalarType type = ScalarType::float32;
  std::optional<ScalarType> list_size;  ///< type of a list's length, where the property is a list
};

struct Element {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<Property> properties;

  bool has_lists() const {
    for (const Property& property : properties)
      if (property.list_size) return true;
    return false;
  }
  /// Bytes of one record without lists.
  std::size_t size() const {
    std::size_t sum = 0;
    for (const Property& property : properties) sum += size_of(property.type);
    return sum;
  }
};

enum class Encoding { ascii, little_endian, big_endian };

struct PlyHeader {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
  std::size_t lines = 0;
  std::size_t data_offset = 0;
};

std::optional<ScalarType> to_scalar_type(std::string_view word) {
  constexpr std::pair<std::string_view, ScalarType> kTypes[] = {
      {"char", ScalarType::int8},       {"int8", ScalarType::int8},      {"uchar", ScalarType::uint8},
      {"uint8", ScalarType::uint8},     {"short", ScalarType::int16},    {"int16", ScalarType::int16},
      {"ushort", ScalarType::uint16},   {"uint16", ScalarType::uint16},  {"int", ScalarType::int32},
      {"int32", ScalarType::int32},     {"uint", ScalarType::uint32},    {"uint32", ScalarType::uint32},
      {"int64", ScalarType::int64},     {"uint64", ScalarType::uint64},  {"float", ScalarType::float32},
      {"float32", ScalarType::float32}, {"double", ScalarType::float64}, {"float64", ScalarType::float64}};
  for (const auto& [name, type] : kTypes)
    if (name == word) return type;
  return std::nullopt;
}

class PlyHeaderReader {
 public:
  PlyHeaderReader(std::string_view bytes, const std::string& name) : lines_(bytes), name_(name) {}

  PlyHeader read() {
    lines_.next();  // "ply"
    bool has_format = false;
    while (true) {
      const std::optional<std::string_view> line = lines_.next();
      if (!line) throw_io_error("{}: truncated: the header has no end_header line", name_);
      const std::vector<std::string_view> words = words_of(*line);
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") break;
      if (words[0] == "format") read_format(words), has_format = true;
      else if (words[0] == "element") read_element(words);
      else if (words[0] == "property") read_property(words);
      else fail("'{}' is no entry of a PLY header", excerpt(words[0]));
    }
    if (!has_format) throw_io_error("{}: the header has no format line", name_);
    header_.lines = lines_.number();
    header_.data_offset = lines_.offset();
    return header_;
  }

 private:
  template <typename... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) const {
    throw_io_error("{}:{}: {}", name_, lines_.number(), fmt::format(format, std::forward<Args>(args)...));
  }

  void read_format(const std::vector<std::string_view>& words) {
    const std::string_view format = words.size() > 1 ? words[1] : "";
    if (format == "ascii") header_.encoding = Encoding::ascii;
    else if (format == "binary_little_endian") header_.encoding = Encoding::little_endian;
    else if (format == "binary_big_endian") header_.encoding = Encoding::big_endian;
    else fail("format '{}' is not valid; valid: ascii, binary_little_endian, binary_big_endian", excerpt(format));
  }

  void read_element(const std::vector<std::string_view>& words) {
    const std::optional<std::uint32_t> count = words.size() == 3 ? to_number<std::uint32_t>(words[2]) : std::nullopt;
    if (!count) fail("an element line is 'element NAME COUNT', with a count from 0 to 4294967295");
    header_.elements.push_back({words[1], *count, {}});
  }

  void read_property(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) fail("a property stands before any element");
    const bool list = words.size() == 5 && words[1] == "list";
    if (!list && words.size() != 3) fail("a property line is 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
    Property property{words.back(), read_type(words[words.size() - 2]), std::nullopt};
    if (list) property.list_size = read_type(words[2]);
    header_.elements.back().properties.push_back(property);
  }

  ScalarType read_type(std::string_view word) const {
    const std::optional<ScalarType> type = to_scalar_type(word);
    if (!type) fail("'{}' is no type of a PLY property", excerpt(word));
    return *type;
  }

  LineScanner lines_;
  const std::string& name_;
  PlyHeader header_;
};

/// Walks over the elements' records, text or binary, never beyond the data.
class Body {
 public:
  Body(std::string_view data, const PlyHeader& header, const std::string& name)
      : data_(data), lines_(data, header.lines), encoding_(header.encoding), name_(name) {}

  void skip(const Element& element) {
    if (element.properties.empty()) return;
    if (encoding_ == Encoding::ascii) {
      for (std::uint64_t i = 0; i < element.count; ++i) take_line(element);
    } else if (!element.has_lists()) {
      take_records(element);
    } else {
      for (std::uint64_t i = 0; i < element.count; ++i) skip_record(element);
    }
  }

  void decode_vertices(const Element& element, double scale, Cloud& cloud) {
    if (element.has_lists()) throw_io_error("{}: vertices with list properties are not supported", name_);
    std::array<bool, kRoleCount> present{};
    for (const Property& property : element.properties) {
      const std::optional<Role> role = role_of(property.name);
      if (role && present[*role])
        throw_io_error("{}: the property {} stands twice in the header", name_, property.name);
      if (role) present[*role] = true;
    }
    require_coordinates(present, name_);
    cloud.width = static_cast<std::uint32_t>(element.count);
    if (encoding_ == Encoding::ascii) decode_ascii_vertices(element, scale, cloud);
    else decode_binary_vertices(element, scale, cloud);
  }

  /// The values of an element's first record by name.
  std::map<std::string_view, double> first_record(const Element& element) {
    std::map<std::string_view, double> values;
    if (encoding_ == Encoding::ascii) {
      std::string_view line = take_line(element);
      for (const Property& property : element.properties) {
        const std::optional<double> value = to_number<double>(take_word(line));
        if (value) values[property.name] = *value;
      }
    } else {
      for (const Property& property : element.properties)
        values[property.name] = scalar_at(take(size_of(property.type), element), property.type, swapped());
    }
    return values;
  }

 private:
  bool swapped() const { return encoding_ == Encoding::big_endian; }

  [[noreturn]] void fail_truncated(const Element& element) const {
    throw_io_error("{}: truncated: {} {} records are announced, but the file ends before that", name_, element.count,
                   excerpt(element.name));
  }

  const char* take(std::size_t size, const Element& element) {
    if (size > data_.size()) fail_truncated(element);
    const char* at = data_.data();
    data_.remove_prefix(size);
    return at;
  }

  const char* take_records(const Element& element) {
    if (element.count > data_.size() / element.size()) fail_truncated(element);
    return take(element.count * element.size(), element);
  }

  std::string_view take_line(const Element& element) {
    const std::optional<std::string_view> line = lines_.next_filled();
    if (!line) fail_truncated(element);
    return *line;
  }

  void skip_record(const Element& element) {
    for (const Property& property : element.properties) {
      if (!property.list_size) {
        take(size_of(property.type), element);
        continue;
      }
      const double count = scalar_at(take(size_of(*property.list_size), element), *property.list_size, swapped());
      if (!(count >= 0.0 && count <= static_cast<double>(data_.size()))) fail_truncated(element);
      take(static_cast<std::size_t>(count) * size_of(property.type), element);
    }
  }

  void decode_ascii_vertices(const Element& element, double scale, Cloud& cloud) {
    AsciiRows rows;
    for (const Property& property : element.properties) {
      const bool floating = property.type == ScalarType::float32 || property.type == ScalarType::float64;
      if (const std::optional<Role> role = role_of(property.name))
        rows.wanted.push_back({rows.values_per_row, *role, !floating});
      ++rows.values_per_row;
    }
    const std::vector<double> values = rows.parse(lines_, element.count, name_);
    rows.columns(values).decode(element.count, scale, name_, cloud);
  }

  void decode_binary_vertices(const Element& element, double scale, Cloud& cloud) {
    const char* records = take_records(element);
    CloudColumns columns;
    std::size_t offset = 0;
    for (const Property& property : element.properties) {
      if (const std::optional<Role> role = role_of(property.name))
        columns.set(*role, {records + offset, element.size(), property.type, swapped()});
      offset += size_of(property.type);
    }
    columns.decode(element.count, scale, name_, cloud);
  }

  std::string_view data_;  ///< what is left of a binary body
  LineScanner lines_;      ///< over a text body
  Encoding encoding_;
  const std::string& name_;
};

/// PCL's camera element: sensor pose, and rows and columns where they fit the points. Other programs' cameras
/// may mean something else, so what does not make sense is left alone.
void apply_camera(const std::map<std::string_view, double>& values, double scale, Cloud& cloud) {
  const auto value = [&](const char* property) {
    const auto found = values.find(property);
    return found == values.end() ? std::nan("") : found->second;
  };
  const Vec3 position(value("view_px"), value("view_py"), value("view_pz"));
  Eigen::Matrix3d rotation;
  rotation << value("x_axisx"), value("x_axisy"), value("x_axisz"), value("y_axisx"), value("y_axisy"),
      value("y_axisz"), value("z_axisx"), value("z_axisy"), value("z_axisz");
  const bool is_rotation = (rotation * rotation.transpose()).isIdentity(1e-3) && rotation.determinant() > 0.0;
  if (position.allFinite() && is_rotation)
    cloud.world_from_sensor = make_pose(Quat(rotation).normalized(), position * scale);
  const double width = value("viewportx");
  const double height = value("viewporty");
  if (width < 1.0 || height < 1.0 || width != std::floor(width) || width * height != static_cast<double>(cloud.size()))
    return;
  cloud.width = static_cast<std::uint32_t>(width);
  cloud.height = static_cast<std::uint32_t>(height);
}

const Element* find(const PlyHeader& header, std::string_view name) {
  for (const Element& element : header.elements)
    if (element.name == name) return &element;
  return nullptr;
}

}  // namespace

bool looks_like_ply(std::string_view bytes) { return bytes.starts_with("ply\n") || bytes.starts_with("ply\r\n"); }

Cloud parse_ply(std::string_view bytes, const std::string& name, double scale) {
  const PlyHeader header = PlyHeaderReader(bytes, name).read();
  const Element* vertices = find(header, "vertex");
  const Element* camera = find(header, "camera");
  if (!vertices) throw_io_error("{}: the header names no vertex element", name);
  if (camera && (camera->count != 1 || camera->has_lists())) camera = nullptr;

  Cloud cloud;
  std::map<std::string_view, double> camera_values;
  Body body(bytes.substr(header.data_offset), header, name);
  const Element* last = camera ? std::max(vertices, camera) : vertices;  // what follows need not even be complete
  for (const Element* element = header.elements.data(); element <= last; ++element) {
    if (element == vertices) body.decode_vertices(*element, scale, cloud);
    else if (element == camera) camera_values = body.first_record(*element);
    else body.skip(*element);
  }
  if (camera) apply_camera(camera_values, scale, cloud);
  return cloud;
}

}  // namespace tubebin::cloud
