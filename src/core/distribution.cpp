#include "tubebin/core/distribution.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace tubebin {
namespace {

/// Standard deviations at which a normal distribution is cut off: a bound that can be checked before anything is drawn.
constexpr double kNormalReach = 3.0;

double normal_within_reach(Random& random) {
  double deviate = random.normal();
  while (std::abs(deviate) > kNormalReach) deviate = random.normal();
  return deviate;
}

}  // namespace

double Distribution::low() const {
  return form == Form::normal ? numbers[0] - kNormalReach * numbers[1] : std::ranges::min(numbers);
}

double Distribution::high() const {
  return form == Form::normal ? numbers[0] + kNormalReach * numbers[1] : std::ranges::max(numbers);
}

double Distribution::draw(Random& random) const {
  switch (form) {
    case Form::uniform:
      if (is_whole) return random.integer(static_cast<int>(numbers[0]), static_cast<int>(numbers[1]));
      return random.uniform(numbers[0], numbers[1]);
    case Form::log_uniform:  // what is rounded may leave the range by the last digit
      return std::clamp(std::exp(random.uniform(std::log(numbers[0]), std::log(numbers[1]))), numbers[0], numbers[1]);
    case Form::normal:
      return std::clamp(numbers[0] + numbers[1] * normal_within_reach(random), low(), high());
    case Form::choice:
      break;
  }
  return numbers[static_cast<std::size_t>(random.integer(0, static_cast<int>(numbers.size()) - 1))];
}

std::string Distribution::text() const {
  const std::string how_often =
      per ? fmt::format(", per: {}", distribution_per_names()[static_cast<std::size_t>(*per)]) : "";
  return fmt::format("{{{}: [{}]{}}}", distribution_form_names()[static_cast<std::size_t>(form)],
                     fmt::join(numbers, ", "), how_often);
}

const std::vector<std::string>& distribution_form_names() {
  static const std::vector<std::string> names = {"uniform", "log_uniform", "normal", "choice"};
  return names;
}

const std::vector<std::string>& distribution_per_names() {
  static const std::vector<std::string> names = {"scene", "tube"};
  return names;
}

}  // namespace tubebin
