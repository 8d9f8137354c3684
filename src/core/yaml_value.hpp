// A node of a YAML file with its place and its key, so that what is wrong can be named.
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

#include "tubebin/core/distribution.hpp"
#include "tubebin/core/fields.hpp"

namespace tubebin {

/// "file:line:column"
std::string place_of(const std::string& file, const YAML::Mark& mark);

struct YamlValue {
  YAML::Node node;
  std::string file;
  std::string key_path;

  /// Throws ConfigError "place: key path: value: what is valid", as all functions do.
  [[noreturn]] void fail(const std::string& valid) const;
  std::string text(const std::string& valid) const;
  void read(double& value, Limits limits, const char* unit) const;
  void read(int& value, Limits limits, const char* unit) const;
  /// The i-th element, or the value of a key.
  YamlValue element(std::size_t i) const;
  YamlValue at(const std::string& key) const;
  std::size_t size() const { return node.size(); }
  std::string place() const { return place_of(file, node.Mark()); }
};

/// A mapping like {uniform: [0.01, 0.02]}, all of whose numbers are within the limits of the number that it stands for.
Distribution read_distribution(const YamlValue& value, Limits limits, const char* unit, bool is_whole);

}  // namespace tubebin
