// The numbers of an options struct by their key paths, to be set by name.
#pragma once

#include <algorithm>
#include <limits>
#include <map>
#include <string>

#include "tubebin/core/fields.hpp"

namespace tubebin {

struct NumberField {
  double* number = nullptr;  ///< one of the two
  int* whole = nullptr;
  Limits limits;

  double get() const { return number != nullptr ? *number : *whole; }
  void set(double value) const {
    if (number != nullptr) *number = value;
    else
      *whole =
          static_cast<int>(std::clamp<double>(value, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()));
  }
};

/// Numbers and whole numbers, those in groups ("physics.gravity"), lists ("kinds[2].radius") and vectors
/// ("scanner.position[0]") included.
std::map<std::string, NumberField> number_fields(const std::function<void(Fields&)>& describe);

}  // namespace tubebin
