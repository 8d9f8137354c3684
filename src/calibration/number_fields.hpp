// The numbers of an options struct by their key paths, to be set by name.
#pragma once

#include <map>
#include <string>

#include "tubebin/core/fields.hpp"

namespace tubebin::calibration {

struct NumberField {
  double* number = nullptr;  ///< one of the two
  int* whole = nullptr;
  Limits limits;

  double get() const { return number != nullptr ? *number : *whole; }
  void set(double value) const {
    if (number != nullptr) *number = value;
    else *whole = static_cast<int>(value);
  }
};

/// Numbers and whole numbers, those in groups included ("region_growing.neighbors"); not those of lists and vectors.
std::map<std::string, NumberField> number_fields(const std::function<void(Fields&)>& describe);

}  // namespace tubebin::calibration
