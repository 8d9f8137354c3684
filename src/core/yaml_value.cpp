#include "core/yaml_value.hpp"

#include <algorithm>
#include <limits>
#include <sstream>

#include "core/limits_text.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/text_scan.hpp"

namespace tubebin {
namespace {

std::string valid_range(Limits limits, const char* unit) {
  return limits_text(limits) + (*unit ? fmt::format(" {}", unit) : "");
}

std::string dump(const YAML::Node& node) {
  if (node.IsNull()) return "nothing";
  if (node.IsScalar()) return node.Scalar();
  std::ostringstream out;
  out << node;
  std::string text = out.str();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

}  // namespace

std::string place_of(const std::string& file, const YAML::Mark& mark) {
  return fmt::format("{}:{}:{}", file, mark.line + 1, mark.column + 1);
}

void YamlValue::fail(const std::string& valid) const {
  throw_config_error("{}: {}: '{}' is not valid; valid: {}", place(), key_path, dump(node), valid);
}

std::string YamlValue::text(const std::string& valid) const {
  if (!node.IsScalar()) fail(valid);
  return node.Scalar();
}

void YamlValue::read(double& value, Limits limits, const char* unit) const {
  const std::string valid = valid_range(limits, unit);
  const auto number = to_number<double>(text(valid));
  if (!number || !(*number >= limits.min && *number <= limits.max)) fail(valid);
  value = *number;
}

void YamlValue::read(int& value, Limits limits, const char* unit) const {
  limits.min = std::max<double>(limits.min, std::numeric_limits<int>::min());
  limits.max = std::min<double>(limits.max, std::numeric_limits<int>::max());
  const std::string valid = "a whole number, " + valid_range(limits, unit);
  // 010 is ten, as on the command line, and not YAML 1.1's eight.
  const auto number = to_number<int>(text(valid));
  if (!number || *number < limits.min || *number > limits.max) fail(valid);
  value = *number;
}

YamlValue YamlValue::element(std::size_t i) const { return {node[i], file, fmt::format("{}[{}]", key_path, i)}; }

YamlValue YamlValue::at(const std::string& key) const {
  return {node[key], file, key_path.empty() ? key : key_path + "." + key};
}

}  // namespace tubebin
