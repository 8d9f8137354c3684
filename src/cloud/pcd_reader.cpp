/// PCD 0.5 to 0.7 (https://pointclouds.org/documentation/tutorials/pcd_file_format.html).
#include <lzf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "cloud/cloud_formats.hpp"
#include "cloud/columns.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/text_scan.hpp"

namespace tubebin::cloud {
namespace {

struct Field {
  std::string_view name;
  std::size_t size = 0;
  char type = 0;
  std::size_t count = 1;
};

enum class Data { ascii, binary, compressed };

struct PcdHeader {
  std::vector<Field> fields;
  std::uint32_t width = 0;
  std::uint32_t height = 1;
  std::uint64_t points = 0;
  Pose world_from_sensor = Pose::Identity();
  Data data = Data::ascii;
  std::size_t lines = 0;
  std::size_t data_offset = 0;

  std::size_t point_size() const {
    std::size_t sum = 0;
    for (const Field& field : fields) sum += field.size * field.count;
    return sum;
  }
};

/// Reads the lines up to DATA.
class PcdHeaderReader {
 public:
  PcdHeaderReader(std::string_view bytes, const std::string& name) : bytes_(bytes), lines_(bytes), name_(name) {}

  PcdHeader read() {
    while (!has_data_) {
      const std::optional<std::string_view> line = lines_.next();
      if (!line) throw_io_error("{}: truncated: the header has no DATA line", name_);
      read_line(*line);
    }
    finish();
    return header_;
  }

 private:
  template <typename... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) const {
    throw_io_error("{}:{}: {}", name_, lines_.number(), fmt::format(format, std::forward<Args>(args)...));
  }

  void read_line(std::string_view line) {
    const std::string_view keyword = take_word(line);
    if (keyword.empty() || keyword.starts_with('#')) return;
    if (keyword == "VERSION") return;
    if (keyword == "FIELDS" || keyword == "COLUMNS") return read_fields(line);
    if (keyword == "SIZE") return read_each(line, "SIZE", [&](Field& f, auto word) { f.size = read_size(word); });
    if (keyword == "TYPE") return read_each(line, "TYPE", [&](Field& f, auto word) { f.type = read_type(word); });
    if (keyword == "COUNT") return read_each(line, "COUNT", [&](Field& f, auto word) { f.count = read_count(word); });
    if (keyword == "WIDTH") return static_cast<void>(header_.width = read_whole(line, "WIDTH"), has_width_ = true);
    if (keyword == "HEIGHT") return static_cast<void>(header_.height = read_whole(line, "HEIGHT"), has_height_ = true);
    if (keyword == "POINTS") return static_cast<void>(header_.points = read_whole(line, "POINTS"), has_points_ = true);
    if (keyword == "VIEWPOINT") return read_viewpoint(line);
    if (keyword == "DATA") return read_data(line);
    fail("'{}' is no entry of a PCD header", excerpt(keyword));
  }

  void read_fields(std::string_view line) {
    if (!header_.fields.empty()) fail("FIELDS stands here a second time");
    for (const std::string_view field : words_of(line)) header_.fields.push_back({field, 0, 0, 1});
    if (header_.fields.empty()) fail("FIELDS names no field");
  }

  template <typename Function>
  void read_each(std::string_view line, const char* what, Function&& read_one) {
    const std::vector<std::string_view> words = words_of(line);
    if (words.size() != header_.fields.size())
      fail("{} has {} entries for {} fields", what, words.size(), header_.fields.size());
    for (std::size_t i = 0; i < words.size(); ++i) read_one(header_.fields[i], words[i]);
  }

  std::size_t read_size(std::string_view word) const {
    if (word != "1" && word != "2" && word != "4" && word != "8")
      fail("SIZE {} is not valid; valid: 1, 2, 4 or 8", excerpt(word));
    return static_cast<std::size_t>(word[0] - '0');
  }

  char read_type(std::string_view word) const {
    if (word != "F" && word != "U" && word != "I") fail("TYPE {} is not valid; valid: F, U or I", excerpt(word));
    return word[0];
  }

  /// A point cannot be larger than its file. PCL takes a count of 0 for 1.
  std::size_t read_count(std::string_view word) const {
    const std::optional<std::uint32_t> count = to_number<std::uint32_t>(word);
    if (!count || *count > bytes_.size()) fail("COUNT {} is not valid", excerpt(word));
    return std::max<std::size_t>(*count, 1);
  }

  std::uint32_t read_whole(std::string_view line, const char* what) const {
    const std::vector<std::string_view> words = words_of(line);
    const std::optional<std::uint32_t> value = words.size() == 1 ? to_number<std::uint32_t>(words[0]) : std::nullopt;
    if (!value)
      fail("{}{} is not valid; valid: a whole number from 0 to {}", what, excerpt(line),
           std::numeric_limits<std::uint32_t>::max());
    return *value;
  }

  void read_viewpoint(std::string_view line) {
    const std::vector<std::string_view> words = words_of(line);
    std::array<double, 7> v{};
    bool valid = words.size() == v.size();
    for (std::size_t i = 0; valid && i < v.size(); ++i) {
      const std::optional<double> number = to_number<double>(words[i]);
      valid = number && std::isfinite(*number);
      if (valid) v[i] = *number;
    }
    const Quat rotation(v[3], v[4], v[5], v[6]);
    // Far from 1 it is no rotation that somebody rounded.
    if (!valid || std::abs(rotation.norm() - 1.0) > 0.01)
      fail("VIEWPOINT{} is not valid; valid: tx ty tz and a unit quaternion qw qx qy qz", excerpt(line));
    header_.world_from_sensor = make_pose(rotation.normalized(), Vec3(v[0], v[1], v[2]));
  }

  void read_data(std::string_view line) {
    const std::string_view kind = take_word(line);
    if (kind == "ascii") header_.data = Data::ascii;
    else if (kind == "binary") header_.data = Data::binary;
    else if (kind == "binary_compressed") header_.data = Data::compressed;
    else fail("DATA {} is not valid; valid: ascii, binary, binary_compressed", excerpt(kind));
    header_.lines = lines_.number();
    header_.data_offset = lines_.offset();
    has_data_ = true;
  }

  void finish() {
    if (header_.fields.empty()) throw_io_error("{}: the header names no FIELDS", name_);
    for (const Field& field : header_.fields) {
      if (field.size == 0 || field.type == 0)
        throw_io_error("{}: the header gives no SIZE and TYPE for its FIELDS", name_);
      if (field.type == 'F' && field.size < 4)
        throw_io_error("{}: field {}: a float of {} bytes is not known", name_, excerpt(field.name), field.size);
    }
    if (!has_width_ && !has_points_) throw_io_error("{}: the header has neither WIDTH nor POINTS", name_);
    if (!has_width_) {
      if (has_height_ && header_.height != 1) throw_io_error("{}: the header has a HEIGHT, but no WIDTH", name_);
      header_.width = static_cast<std::uint32_t>(header_.points);
    }
    const std::uint64_t grid = std::uint64_t{header_.width} * header_.height;
    if (has_points_ && grid != header_.points)
      throw_io_error("{}: the header says {} points, but {} x {}", name_, header_.points, header_.width,
                     header_.height);
    header_.points = grid;
    if (grid == 0) header_.width = 0, header_.height = 1;
  }

  std::string_view bytes_;
  LineScanner lines_;
  const std::string& name_;
  PcdHeader header_;
  bool has_width_ = false;
  bool has_height_ = false;
  bool has_points_ = false;
  bool has_data_ = false;
};

ScalarType scalar_type(const Field& field) {
  if (field.type == 'F') return field.size == 4 ? ScalarType::float32 : ScalarType::float64;
  const bool is_signed = field.type == 'I';
  switch (field.size) {
    case 1:
      return is_signed ? ScalarType::int8 : ScalarType::uint8;
    case 2:
      return is_signed ? ScalarType::int16 : ScalarType::uint16;
    case 4:
      return is_signed ? ScalarType::int32 : ScalarType::uint32;
    default:
      return is_signed ? ScalarType::int64 : ScalarType::uint64;
  }
}

/// Calls f(role, field, bytes before the field, values before the field) for every field that a cloud keeps.
template <typename Function>
void for_each_role(const PcdHeader& header, const std::string& name, Function&& f) {
  std::array<bool, kRoleCount> present{};
  std::size_t offset = 0;
  std::size_t position = 0;
  for (const Field& field : header.fields) {
    const std::optional<Role> role = role_of(field.name);
    if (role && present[*role]) throw_io_error("{}: the field {} stands twice in the header", name, field.name);
    if (role && field.count != 1)
      throw_io_error("{}: the field {} has {} values a point; expected 1", name, field.name, field.count);
    if (role) {
      present[*role] = true;
      f(*role, field, offset, position);
    }
    offset += field.size * field.count;
    position += field.count;
  }
  require_coordinates(present, name);
}

[[noreturn]] void fail_truncated(const PcdHeader& header, std::size_t available, const std::string& name) {
  throw_io_error("{}: truncated: {} points of {} bytes are announced, but only {} bytes are there", name, header.points,
                 header.point_size(), available);
}

void decode_ascii(const PcdHeader& header, std::string_view data, const std::string& name, double scale, Cloud& cloud) {
  AsciiRows rows;
  for (const Field& field : header.fields) rows.values_per_row += field.count;
  for_each_role(header, name, [&](Role role, const Field& field, std::size_t, std::size_t position) {
    rows.wanted.push_back({position, role, field.type != 'F'});
  });
  LineScanner lines(data, header.lines);
  const std::vector<double> values = rows.parse(lines, header.points, name);
  if (lines.next_filled())
    throw_io_error("{}:{}: the header says {} points, but there are more", name, lines.number(), header.points);
  rows.columns(values).decode(header.points, scale, name, cloud);
}

void decode_binary(const PcdHeader& header, std::string_view data, const std::string& name, double scale,
                   Cloud& cloud) {
  const std::size_t stride = header.point_size();
  CloudColumns columns;
  for_each_role(header, name, [&](Role role, const Field& field, std::size_t offset, std::size_t) {
    columns.set(role, {data.data() + offset, stride, scalar_type(field), false});
  });
  if (header.points > data.size() / stride) fail_truncated(header, data.size(), name);
  // Less than a point may be a writer's padding.
  if (data.size() - header.points * stride >= stride)
    throw_io_error("{}: the header says {} points of {} bytes, but there are {} bytes more", name, header.points,
                   stride, data.size() - header.points * stride);
  columns.decode(header.points, scale, name, cloud);
}

/// A small file may announce many points. Whole images of a camera, nearly all of whose pixels saw nothing, need a hundred
/// times their compressed bytes and stay below the lower bound; a compressor's bomb does not.
void require_memory(const PcdHeader& header, std::size_t unpacked, std::size_t packed, const std::string& name) {
  constexpr std::size_t kAlwaysAllowed = std::size_t{256} << 20;  // bytes
  constexpr std::size_t kMultiple = 64;
  const std::size_t needed = unpacked + header.points * (sizeof(Point) + sizeof(Color) + 2 * sizeof(Label));
  if (needed > std::max(kAlwaysAllowed, kMultiple * packed))
    throw_io_error("{}: its {} points would take {} bytes of memory; valid: up to {} times the {} compressed bytes",
                   name, header.points, needed, kMultiple, packed);
}

/// The fields one after the other, each with all its points' values.
std::vector<char> decompress(const PcdHeader& header, std::string_view data, const std::string& name) {
  constexpr std::size_t kSizes = 2 * sizeof(std::uint32_t);
  // Three bytes of LZF stand for 264 at most (liblzf's format: runs of 2 to 264 bytes, in 2 or 3).
  constexpr std::size_t kLongestRun = 264;
  if (header.points == 0) return {};
  if (data.size() < kSizes) fail_truncated(header, data.size(), name);
  std::uint32_t packed = 0;
  std::uint32_t unpacked = 0;
  std::memcpy(&packed, data.data(), sizeof(packed));
  std::memcpy(&unpacked, data.data() + sizeof(packed), sizeof(unpacked));
  data.remove_prefix(kSizes);
  if (packed > data.size())
    throw_io_error("{}: truncated: {} compressed bytes are announced, but only {} are there", name, packed,
                   data.size());
  if (header.points > unpacked / header.point_size() || header.points * header.point_size() != unpacked)
    throw_io_error("{}: {} points of {} bytes cannot be the {} bytes that the compressed data announces", name,
                   header.points, header.point_size(), unpacked);
  if (unpacked / kLongestRun > packed)
    throw_io_error("{}: {} compressed bytes cannot hold the {} that are announced", name, packed, unpacked);
  require_memory(header, unpacked, packed, name);
  std::vector<char> out(unpacked);
  if (lzf_decompress(data.data(), packed, out.data(), unpacked) != unpacked)
    throw_io_error("{}: the compressed data is damaged", name);
  return out;
}

void decode_compressed(const PcdHeader& header, std::string_view data, const std::string& name, double scale,
                       Cloud& cloud) {
  const std::vector<char> fields = decompress(header, data, name);
  CloudColumns columns;
  for_each_role(header, name, [&](Role role, const Field& field, std::size_t offset, std::size_t) {
    columns.set(role, {fields.data() + offset * header.points, field.size, scalar_type(field), false});
  });
  columns.decode(header.points, scale, name, cloud);
}

}  // namespace

bool looks_like_pcd(std::string_view bytes) {
  LineScanner lines(bytes);
  while (std::optional<std::string_view> line = lines.next()) {
    const std::string_view keyword = take_word(*line);
    if (keyword.empty() || keyword.starts_with('#')) continue;
    return keyword == "VERSION" || keyword == "FIELDS" || keyword == "COLUMNS";
  }
  return bytes.starts_with("# .PCD");
}

Cloud parse_pcd(std::string_view bytes, const std::string& name, double scale) {
  const PcdHeader header = PcdHeaderReader(bytes, name).read();
  const std::string_view data = bytes.substr(header.data_offset);
  Cloud cloud;
  cloud.width = header.width;
  cloud.height = header.height;
  cloud.world_from_sensor = header.world_from_sensor;
  cloud.world_from_sensor.translation() *= scale;
  if (header.data == Data::ascii) decode_ascii(header, data, name, scale, cloud);
  else if (header.data == Data::binary) decode_binary(header, data, name, scale, cloud);
  else decode_compressed(header, data, name, scale, cloud);
  return cloud;
}

}  // namespace tubebin::cloud
