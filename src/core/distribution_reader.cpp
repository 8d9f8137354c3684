#include <algorithm>

#include "core/limits_text.hpp"
#include "core/yaml_value.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin {
namespace {

using Form = Distribution::Form;

std::string valid_forms(bool is_whole) {
  return is_whole ? "{uniform: [first, last]} or {choice: [a, b, ...]}, since the number is a whole one"
                  : "{uniform: [low, high]}, {log_uniform: [low, high]}, {normal: [mean, standard deviation]} or "
                    "{choice: [a, b, ...]}";
}

/// Index of the text among the names; as many as there are names where it is none.
std::size_t index_of(const std::string& text, const std::vector<std::string>& names) {
  return static_cast<std::size_t>(std::ranges::find(names, text) - names.begin());
}

double read_number(const YamlValue& value, Limits limits, const char* unit, bool is_whole) {
  double number = 0.0;
  int whole = 0;
  if (!is_whole) value.read(number, limits, unit);
  else value.read(whole, limits, unit);
  return is_whole ? whole : number;
}

void check_bounds(const YamlValue& list, const Distribution& distribution, Limits limits, const char* unit) {
  const std::vector<double>& numbers = distribution.numbers;
  if (distribution.form == Form::normal && (distribution.low() < limits.min || distribution.high() > limits.max))
    list.fail(fmt::format("three standard deviations to either side of the mean ({} to {}) that stay within {}{}{}",
                          distribution.low(), distribution.high(), limits_text(limits), *unit ? " " : "", unit));
  if (distribution.form == Form::log_uniform && numbers[0] <= 0.0) list.fail("numbers above 0");
  const bool is_range = distribution.form == Form::uniform || distribution.form == Form::log_uniform;
  if (is_range && numbers[0] > numbers[1]) list.fail("the lower number first");
}

std::vector<double> read_numbers(const YamlValue& list, Form form, Limits limits, const char* unit, bool is_whole) {
  const bool is_pair = form != Form::choice;
  if (!list.node.IsSequence() || list.size() == 0 || (is_pair && list.size() != 2))
    list.fail(is_pair ? "a list of two numbers" : "a list of numbers");
  std::vector<double> numbers;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const bool is_deviation = form == Form::normal && i == 1;
    numbers.push_back(read_number(list.element(i), is_deviation ? Limits{.min = 0.0} : limits, unit, is_whole));
  }
  return numbers;
}

}  // namespace

Distribution read_distribution(const YamlValue& value, Limits limits, const char* unit, bool is_whole) {
  Distribution distribution{.is_whole = is_whole};
  std::size_t forms = 0;
  for (const auto& entry : value.node) {
    const YamlValue key{entry.first, value.file, value.key_path};
    const std::string name = key.text(valid_forms(is_whole));
    const YamlValue inner = value.at(name);
    if (name == "per") {
      const std::size_t per = index_of(inner.text("scene, tube"), distribution_per_names());
      if (per == distribution_per_names().size()) inner.fail("scene, tube");
      distribution.per = static_cast<Distribution::Per>(per);
      continue;
    }
    const std::size_t form = index_of(name, distribution_form_names());
    distribution.form = static_cast<Form>(form);
    const bool is_known = form < distribution_form_names().size() &&
                          !(is_whole && distribution.form != Form::uniform && distribution.form != Form::choice);
    if (!is_known || ++forms > 1) value.fail(valid_forms(is_whole));
    distribution.numbers = read_numbers(inner, distribution.form, limits, unit, is_whole);
    check_bounds(inner, distribution, limits, unit);
  }
  if (forms == 0) value.fail(valid_forms(is_whole));
  return distribution;
}

}  // namespace tubebin
