/// Strict YAML: every key is known, every value has the right type and lies within its limits, and what is wrong
/// is named as file:line:column, key path, value, and what would be valid.
#pragma once

#include <map>
#include <string>

#include "tubebin/core/error.hpp"
#include "tubebin/core/fields.hpp"

namespace tubebin {

/// Where each key that a file sets stands ("tube.radius" -> "set_a.yaml:4:11"), for checks across several keys.
class KeyPlaces {
 public:
  void set(const std::string& key_path, const std::string& place) { places_[key_path] = place; }
  /// The place of the key, else of the nearest enclosing mapping, else of the file.
  std::string find(const std::string& key_path) const;

  /// Throws ConfigError "place: key_path: problem".
  [[noreturn]] void fail(const std::string& key_path, const std::string& problem) const;

 private:
  std::map<std::string, std::string> places_;
};

/// Reads the YAML file onto the fields that `describe` names; a field whose key is missing keeps its value.
/// A top-level key `include: other.yaml` (path relative to the file) reads that file first.
/// Throws ConfigError on anything that is wrong with the file or a value.
KeyPlaces read_yaml_file(const std::string& path, const std::function<void(Fields&)>& describe);

/// As read_yaml_file, from a text; `name` stands for the file in messages. No `include` here.
KeyPlaces read_yaml_text(const std::string& text, const std::string& name,
                         const std::function<void(Fields&)>& describe);

/// The fields as YAML that reads back to the same values, each with its unit and effect as a comment.
std::string write_yaml(const std::function<void(Fields&)>& describe);

/// One field as texts: "tube.radius", "0.0125".
struct KeyValue {
  std::string key_path;
  std::string value;

  friend bool operator==(const KeyValue&, const KeyValue&) = default;
};

/// The fields in their order, for comparing two configurations key by key.
std::vector<KeyValue> list_fields(const std::function<void(Fields&)>& describe);

/// The fields as a Markdown table: key, default, unit, valid values, effect.
std::string document_fields(const std::function<void(Fields&)>& describe);

}  // namespace tubebin
