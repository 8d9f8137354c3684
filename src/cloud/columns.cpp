#include "cloud/columns.hpp"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <utility>

#include "tubebin/core/error.hpp"
#include "tubebin/core/text_scan.hpp"

namespace tubebin::cloud {
namespace {

constexpr double kMaxUint32 = std::numeric_limits<std::uint32_t>::max();

template <typename Scalar>
Scalar load(const char* bytes, bool swapped) {
  std::array<char, sizeof(Scalar)> buffer;
  std::memcpy(buffer.data(), bytes, sizeof(Scalar));
  if (swapped) std::reverse(buffer.begin(), buffer.end());
  return std::bit_cast<Scalar>(buffer);
}

/// Calls f with a value of the type's C++ type.
template <typename Function>
auto with_type(ScalarType type, Function&& f) {
  switch (type) {
    case ScalarType::int8:
      return f(std::int8_t{});
    case ScalarType::uint8:
      return f(std::uint8_t{});
    case ScalarType::int16:
      return f(std::int16_t{});
    case ScalarType::uint16:
      return f(std::uint16_t{});
    case ScalarType::int32:
      return f(std::int32_t{});
    case ScalarType::uint32:
      return f(std::uint32_t{});
    case ScalarType::int64:
      return f(std::int64_t{});
    case ScalarType::uint64:
      return f(std::uint64_t{});
    case ScalarType::float32:
      return f(float{});
    case ScalarType::float64:
      break;
  }
  return f(double{});
}

/// Calls f(i, value) for every point.
template <typename Function>
void for_each_value(const Column& column, std::size_t count, Function&& f) {
  with_type(column.type, [&](auto zero) {
    const char* bytes = column.first;
    for (std::size_t i = 0; i < count; ++i, bytes += column.stride) f(i, load<decltype(zero)>(bytes, column.swapped));
  });
}

template <typename Scalar>
std::uint32_t to_uint32(Scalar value, const char* what, std::size_t point, const std::string& name) {
  const auto number = static_cast<double>(value);
  if (!(number >= 0.0 && number <= kMaxUint32) || number != std::floor(number))
    throw_io_error("{}: point {}: {} {} is not valid; valid: a whole number from 0 to {}", name, point, what, number,
                   std::numeric_limits<std::uint32_t>::max());
  return static_cast<std::uint32_t>(number);
}

/// A colour channel from 0 to `full`, as a byte.
Color to_channel(double value, double full, std::size_t point, const std::string& name) {
  if (!(value >= 0.0 && value <= full))
    throw_io_error("{}: point {}: colour value {} is not valid; valid: 0 to {}", name, point, value, full);
  return static_cast<Color>(std::lround(value / full * 255.0));
}

/// Floating-point channels go from 0 to 1, those of whole numbers from 0 to 255.
double full_channel(const Column& column) {
  const bool floating = column.type == ScalarType::float32 || column.type == ScalarType::float64;
  return floating && !column.whole ? 1.0 : 255.0;
}

/// A colour whose float was written as text: old writers give the float itself, newer ones its bits as a
/// number.
double packed_color_bits(std::string_view word, double number) {
  const bool bits = word.find_first_not_of("0123456789") == std::string_view::npos;
  if (bits) return number;
  // A colour with an alpha of 255 is a NaN for half of the reds; its text has lost it.
  if (std::isnan(number)) return kNullColor;
  return std::bit_cast<std::uint32_t>(static_cast<float>(number));
}

/// As to_number, but what is beyond a double becomes zero or infinite instead of being refused.
std::optional<double> to_coordinate(std::string_view word) {
  if (const std::optional<double> number = to_number<double>(word)) return number;
  const std::string text(word);
  char* end = nullptr;
  errno = 0;
  const double value = std::strtod(text.c_str(), &end);
  return errno == ERANGE && end == text.c_str() + text.size() ? std::optional(value) : std::nullopt;
}

/// Fills `words` with the line's words, which must be as many.
void split_row(std::string_view line, std::vector<std::string_view>& words, std::size_t line_number,
               const std::string& name) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    words[i] = take_word(line);
    if (words[i].empty()) throw_io_error("{}:{}: expected {} values, found {}", name, line_number, words.size(), i);
  }
  if (!take_word(line).empty())
    throw_io_error("{}:{}: expected {} values, found more", name, line_number, words.size());
}

}  // namespace

std::size_t size_of(ScalarType type) {
  return with_type(type, [](auto zero) { return sizeof(zero); });
}

double scalar_at(const char* bytes, ScalarType type, bool swapped) {
  return with_type(type, [&](auto zero) { return static_cast<double>(load<decltype(zero)>(bytes, swapped)); });
}

std::optional<Role> role_of(std::string_view field_name) {
  constexpr std::pair<std::string_view, Role> kRoles[] = {
      {"x", kX},     {"y", kY},         {"z", kZ},       {"rgb", kPackedColor}, {"rgba", kPackedColor},
      {"red", kRed}, {"green", kGreen}, {"blue", kBlue}, {"label", kLabel},     {"source", kSource}};
  for (const auto& [name, role] : kRoles)
    if (name == field_name) return role;
  return std::nullopt;
}

void require_coordinates(const std::array<bool, kRoleCount>& present, const std::string& name) {
  if (present[kX] && present[kY] && present[kZ]) return;
  throw_io_error("{}: a cloud needs the fields x, y and z; missing here:{}{}{}", name, present[kX] ? "" : " x",
                 present[kY] ? "" : " y", present[kZ] ? "" : " z");
}

void CloudColumns::decode(std::size_t count, double scale, const std::string& name, Cloud& cloud) const {
  if (count == 0) return;
  cloud.points.resize(count);
  for (const Role role : {kX, kY, kZ})
    for_each_value(*columns_[role], count, [&](std::size_t i, auto value) {
      cloud.points[i][role - kX] = static_cast<float>(static_cast<double>(value) * scale);
    });
  decode_colors(count, name, cloud);
  if (has(kLabel)) {
    cloud.labels.resize(count);
    for_each_value(*columns_[kLabel], count,
                   [&](std::size_t i, auto value) { cloud.labels[i] = to_uint32(value, "label", i, name); });
  }
  if (has(kSource)) {
    cloud.sources.resize(count);
    for_each_value(*columns_[kSource], count,
                   [&](std::size_t i, auto value) { cloud.sources[i] = to_uint32(value, "source", i, name); });
  }
}

void CloudColumns::decode_colors(std::size_t count, const std::string& name, Cloud& cloud) const {
  constexpr Color kWithoutAlpha = 0x00FFFFFF;
  if (has(kPackedColor)) {
    Column packed = *columns_[kPackedColor];
    // The four bytes are the colour, whatever their type; as a float they may be a NaN.
    if (size_of(packed.type) == sizeof(Color)) packed.type = ScalarType::uint32;
    cloud.colors.resize(count);
    for_each_value(packed, count, [&](std::size_t i, auto value) {
      cloud.colors[i] = to_uint32(value, "packed colour", i, name) & kWithoutAlpha;
    });
  } else if (has(kRed) && has(kGreen) && has(kBlue)) {
    cloud.colors.assign(count, kNullColor);
    for (const Role role : {kRed, kGreen, kBlue}) {
      const double full = full_channel(*columns_[role]);
      for_each_value(*columns_[role], count, [&](std::size_t i, auto value) {
        cloud.colors[i] |= to_channel(static_cast<double>(value), full, i, name) << (8 * (kBlue - role));
      });
    }
  }
}

std::vector<double> AsciiRows::parse(LineScanner& lines, std::size_t rows, const std::string& name) const {
  if (rows == 0) return {};
  // Every value but the last takes a character and a separator.
  if (rows > (lines.remaining() + 1) / (2 * values_per_row))
    throw_io_error("{}: truncated: {} points are announced, but only {} bytes are there", name, rows,
                   lines.remaining());
  std::vector<double> values;
  values.reserve(rows * wanted.size());
  std::vector<std::string_view> words(values_per_row);
  for (std::size_t row = 0; row < rows; ++row) {
    std::optional<std::string_view> line = lines.next_filled();
    if (!line) throw_io_error("{}: truncated: {} points are announced, but only {} are there", name, rows, row);
    split_row(*line, words, lines.number(), name);
    for (const Wanted& value : wanted) {
      const std::string_view word = words[value.position];
      const std::optional<double> number = to_coordinate(word);
      if (!number) throw_io_error("{}:{}: '{}' is not a number", name, lines.number(), excerpt(word));
      const bool packed_float = value.role == kPackedColor && !value.whole;
      values.push_back(packed_float ? packed_color_bits(word, *number) : *number);
    }
  }
  return values;
}

CloudColumns AsciiRows::columns(const std::vector<double>& values) const {
  CloudColumns columns;
  if (values.empty()) return columns;
  for (std::size_t k = 0; k < wanted.size(); ++k)
    columns.set(wanted[k].role, {reinterpret_cast<const char*>(values.data() + k), wanted.size() * sizeof(double),
                                 ScalarType::float64, false, wanted[k].whole});
  return columns;
}

}  // namespace tubebin::cloud
