/// Values out of a JSON file, each with its JSON pointer (RFC 6901), so that what is wrong can be named.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "tubebin/core/error.hpp"
#include "tubebin/core/fields.hpp"

namespace tubebin {

/// The longest JSON text that is read. Values take up to 32 times the memory of their text.
constexpr std::size_t kJsonBytesMax = 64 << 20;

/// Parses the text; throws IoError "name:line:column: ..." where it is no JSON, is nested more than 100 deep, or is longer
/// than kJsonBytesMax. All JSON is read here: the library itself recurses as deep as a text asks.
nlohmann::json parse_json(std::string_view text, const std::string& name);
/// The same, with the keys of objects in their order.
nlohmann::ordered_json parse_ordered_json(std::string_view text, const std::string& name);

/// The file's JSON likewise.
nlohmann::ordered_json read_json(const std::string& path);

/// A value and where it stands. All functions throw IoError naming file, pointer, value and what would be
/// right.
class JsonPlace {
 public:
  JsonPlace(const nlohmann::json& root, const std::string& file) : JsonPlace(root, file, "") {}

  bool has(const char* key) const { return value_.is_object() && value_.contains(key); }
  JsonPlace at(const char* key) const;
  /// The elements of an array; with `count`, exactly so many.
  std::vector<JsonPlace> elements() const;
  std::vector<JsonPlace> elements(std::size_t count) const;

  double number(Limits limits = {}) const;
  /// A whole number from min to max.
  std::uint64_t whole(std::uint64_t min, std::uint64_t max) const;
  int integer(Limits limits) const;
  bool flag() const;
  std::string text() const;
  Vec3 vector(Limits limits = {}) const;
  Pose pose() const;
  /// An object of numbers.
  std::map<std::string, double> numbers() const;
  /// Fills the fields that `describe` names; all of them must be there.
  void fields(const std::function<void(Fields&)>& describe) const;

  /// A number that derives from others must be what they give.
  void expect_near(double expected, double tolerance) const;

  [[noreturn]] void fail(const std::string& valid) const;

 private:
  JsonPlace(const nlohmann::json& value, const std::string& file, std::string pointer)
      : value_(value), file_(file), pointer_(std::move(pointer)) {}

  const nlohmann::json& value_;
  const std::string& file_;
  std::string pointer_;
};

}  // namespace tubebin
