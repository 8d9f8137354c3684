// Which parameters calibrate_modeler tunes, and over what ranges.
#include <algorithm>
#include <charconv>

#include "core/number_fields.hpp"
#include "tubebin/calibration/calibration.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin::calibration {
namespace {

constexpr SearchRange linear(double low, double high) { return {.low = low, .high = high}; }
constexpr SearchRange factors(double low, double high) { return {.low = low, .high = high, .logarithmic = true}; }
constexpr SearchRange whole_factors(double low, double high) {
  return {.low = low, .high = high, .logarithmic = true, .whole = true};
}

double parse_number(std::string_view text, const std::string& all) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size())
    throw_config_error("--parameter {}: '{}' is no number; write KEY=LOW:HIGH or KEY=LOW:HIGH:log", all, text);
  return value;
}

SearchRange parse_range(std::string text, const std::string& all) {
  SearchRange range;
  if (text.ends_with(":log")) {
    range.logarithmic = true;
    text.resize(text.size() - 4);
  }
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos)
    throw_config_error("--parameter {}: '{}' is no range; write KEY=LOW:HIGH or KEY=LOW:HIGH:log", all, text);
  range.low = parse_number(std::string_view(text).substr(0, colon), all);
  range.high = parse_number(std::string_view(text).substr(colon + 1), all);
  return range;
}

SearchRange default_range(const std::string& key, const std::string& all) {
  for (const auto method : modeling::all_methods())
    for (const TunedParameter& parameter : default_parameters(method))
      if (parameter.key == key) return parameter.range;
  throw_config_error("--parameter {}: has no range of its own; write {}=LOW:HIGH", all, key);
}

void check_range(const TunedParameter& parameter, const NumberField& field, const std::string& all) {
  const auto& [low, high, logarithmic, whole] = parameter.range;
  if (!(low < high)) throw_config_error("--parameter {}: the range's low end is not below its high end", all);
  if (low < field.limits.min || high > field.limits.max)
    throw_config_error("--parameter {}: {} may be from {} to {}", all, parameter.key, field.limits.min,
                       field.limits.max);
  if (logarithmic && low <= 0.0) throw_config_error("--parameter {}: a log range is above 0", all);
  if (whole && (low != std::round(low) || high != std::round(high)))
    throw_config_error("--parameter {}: {} takes whole numbers", all, parameter.key);
}

}  // namespace

std::vector<TunedParameter> default_parameters(modeling::ModelingMethod method) {
  if (method == modeling::ModelingMethod::centerline) return {};
  return {{"region_growing.neighbors", whole_factors(8, 60)},
          {"region_growing.smoothness_deg", factors(3, 30)},
          {"region_growing.region_size_min", whole_factors(5, 200)},
          {"region_growing.ransac_iterations", whole_factors(30, 1000)},
          {"region_growing.inlier_distance", factors(0.03, 0.5)},
          {"greedy_joining.gap_max", factors(0.02, 0.2)},
          {"greedy_joining.angle_max_deg", linear(15, 120)},
          {"greedy_joining.angle_cost", factors(0.0002, 0.01)},
          {"greedy_joining.length_max", linear(0.3, 1.2)}};
}

TunedParameter parse_parameter(const std::string& text) {
  const std::size_t equals = text.find('=');
  TunedParameter parameter = {.key = text.substr(0, equals), .range = {}};
  if (parameter.key.starts_with("filtering."))
    throw_config_error(
        "--parameter {}: filtering decides which points are counted, so micro-recall with and without it don't compare",
        text);
  results::ModelConfig config;
  const auto fields = number_fields([&](Fields& visitor) { describe(visitor, config); });
  const auto field = fields.find(parameter.key);
  if (field == fields.end())
    throw_config_error(
        "--parameter {}: '{}' is no number of a configuration; model_tubes --config-reference lists them", text,
        parameter.key);
  parameter.range =
      equals == std::string::npos ? default_range(parameter.key, text) : parse_range(text.substr(equals + 1), text);
  parameter.range.whole = field->second.whole != nullptr;
  check_range(parameter, field->second, text);
  return parameter;
}

}  // namespace tubebin::calibration
