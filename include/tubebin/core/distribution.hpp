/// Numbers that a configuration leaves open: each is drawn, from a seed, by whoever uses the configuration.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tubebin/core/random.hpp"

namespace tubebin {

/// What one number is drawn from.
struct Distribution {
  enum class Form {
    uniform,      ///< from the first number to the second; whole numbers include both
    log_uniform,  ///< likewise, with a uniform logarithm; both are above 0
    normal,       ///< by mean and standard deviation; beyond three of these from the mean it is drawn again
    choice        ///< one of the numbers, each as likely
  };
  /// How often it is drawn.
  enum class Per { scene, tube };

  Form form = Form::uniform;
  std::vector<double> numbers = {0.0, 0.0};
  bool is_whole = false;
  std::optional<Per> per = {};  ///< nothing: as the key's kind has it

  /// The bounds of what is drawn.
  double low() const;
  double high() const;
  double draw(Random& random) const;
  /// As YAML: "{uniform: [0.008, 0.016], per: scene}".
  std::string text() const;
};

const std::vector<std::string>& distribution_form_names();
const std::vector<std::string>& distribution_per_names();

/// By key path: "tube.radius", "scanner.position[0]".
using Distributions = std::map<std::string, Distribution>;
using DrawnNumbers = std::map<std::string, double>;

}  // namespace tubebin
