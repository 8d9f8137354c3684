/// JSON files of others, checked before they are trusted.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace tubebin {

using Json = nlohmann::json;

/// A value in a JSON file, with the place that messages name.
class JsonPlace {
 public:
  JsonPlace(const Json& value, std::string file, std::string pointer = "")
      : value_(value), file_(std::move(file)), pointer_(std::move(pointer)) {}

  const Json& value() const { return value_; }
  bool has(const char* key) const { return value_.is_object() && value_.contains(key); }
  /// The object's member. Throws IoError where there is none.
  JsonPlace at(const char* key) const;
  /// The array's elements. Throws IoError where it is no array.
  std::vector<JsonPlace> elements() const;
  /// The array's elements, `count` of them.
  std::vector<JsonPlace> elements(std::size_t count) const;

  std::string text() const;
  double number() const;
  bool flag() const;
  /// A whole number in [min, max].
  std::int64_t integer(std::int64_t min, std::int64_t max) const;

  /// Throws IoError "file: /pointer: problem".
  [[noreturn]] void fail(const std::string& problem) const;

 private:
  const Json& value_;
  std::string file_;
  std::string pointer_;
};

/// Throws IoError naming the file, and line and column where it is no JSON.
Json read_json_file(const std::string& path);

/// As read_json_file, from a text; `name` stands for the file in messages.
Json parse_json(const std::string& text, const std::string& name);

}  // namespace tubebin
