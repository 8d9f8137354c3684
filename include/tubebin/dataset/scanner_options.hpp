/// A scanner as a configuration has it.
#pragma once

#include <optional>
#include <string>

#include "tubebin/scene/place_surroundings.hpp"

namespace tubebin::dataset {

struct ScannerOptions : scene::Scanner {
  std::optional<Vec3> look_at;  ///< metres, world frame: what the optical axis meets, instead of rotation_deg

  /// The scanner, turned to what it looks at.
  scene::Scanner posed() const;
};

/// With its effects.
void describe(Fields& fields, ScannerOptions& scanner);
/// Throws ConfigError, also where the scanner stands in a wall of the bin or in the table; `prefix` is the scanner's key
/// path.
void check(const ScannerOptions& scanner, const scene::Bin& bin, const scene::SurroundingsOptions& surroundings,
           const KeyPlaces& places, const std::string& prefix);

}  // namespace tubebin::dataset
