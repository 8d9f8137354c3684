/// Values a point at fixed distances in memory: the common ground of every binary layout, of PCD's
/// field-by-field compressed layout, and of parsed text.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/core/text_scan.hpp"

namespace tubebin::cloud {

enum class ScalarType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };
std::size_t size_of(ScalarType type);

struct Column {
  const char* first = nullptr;
  std::size_t stride = 0;  ///< bytes from one point's value to the next
  ScalarType type = ScalarType::float32;
  bool swapped = false;  ///< big endian in memory
  bool whole = false;    ///< a whole-number field, though its values stand here as float64 (parsed text)
};

/// The value at `bytes` as a double.
double scalar_at(const char* bytes, ScalarType type, bool swapped);

/// What a field means to a cloud.
enum Role : std::uint8_t { kX, kY, kZ, kPackedColor, kRed, kGreen, kBlue, kLabel, kSource, kRoleCount };
std::optional<Role> role_of(std::string_view field_name);

class CloudColumns {
 public:
  bool has(Role role) const { return columns_[role].has_value(); }
  void set(Role role, const Column& column) { columns_[role] = column; }

  /// Fills points, colours and labels of `count` points. Throws IoError where a colour or label is no such
  /// thing.
  void decode(std::size_t count, double scale, const std::string& name, Cloud& cloud) const;

 private:
  void decode_colors(std::size_t count, const std::string& name, Cloud& cloud) const;

  std::array<std::optional<Column>, kRoleCount> columns_;
};

/// Throws IoError where one of x, y, z is missing.
void require_coordinates(const std::array<bool, kRoleCount>& present, const std::string& name);

/// Rows of numbers in a text. Values that are wanted become doubles; a value of the others may be anything.
struct AsciiRows {
  struct Wanted {
    std::size_t position = 0;  ///< in the row, from 0
    Role role = kX;
    bool whole = false;  ///< the field is declared as a whole number
  };
  std::size_t values_per_row = 0;
  std::vector<Wanted> wanted;

  /// Parses the next `rows` rows; row r's k-th wanted value is at [r * wanted.size() + k].
  /// Throws IoError naming the line.
  std::vector<double> parse(LineScanner& lines, std::size_t rows, const std::string& name) const;
  /// Columns over parsed values.
  CloudColumns columns(const std::vector<double>& values) const;
};

}  // namespace tubebin::cloud
