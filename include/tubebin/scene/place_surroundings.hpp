/// Draws what stands around a bin.
#pragma once

#include <string>

#include "tubebin/core/random.hpp"
#include "tubebin/scene/scene.hpp"

namespace tubebin::scene {

/// Metres but where the name says otherwise. Each size is uniform between its limits.
struct SurroundingsOptions {
  double table_length = 0.0;  ///< along x; 0: no table, and nothing that stands on it
  double table_width = 0.0;   ///< along y
  double table_thickness = 0.03;
  int box_count_min = 0;
  int box_count_max = 0;
  double box_size_min = 0.05;  ///< of each edge
  double box_size_max = 0.2;
  int cylinder_count_min = 0;
  int cylinder_count_max = 0;
  double cylinder_radius_min = 0.03;
  double cylinder_radius_max = 0.06;
  double cylinder_height_min = 0.08;
  double cylinder_height_max = 0.3;
  int bins = 0;             ///< further ones
  double clearance = 0.03;  ///< between any two objects
};

void describe(Fields& fields, SurroundingsOptions& options);
void check(const SurroundingsOptions& options, const Bin& bin, const KeyPlaces& places, const std::string& prefix);

/// The bin stands on it, with its middle above the table's.
StandingBox table_of(const SurroundingsOptions& options, const Bin& bin);

struct PlacedSurroundings {
  std::optional<Surroundings> surroundings;  ///< none without a table
  std::string problem;                       ///< which object found no free place; empty where all did
};

/// Further bins, then boxes, then cylinders, each at the first of up to a thousand drawn places that is wholly on the table
/// and leaves it `clearance` of the bin, the tubes, the scanners and the objects before it. Two bodies are clear of each other
/// if seen from above, or in height, there is as much between them.
PlacedSurroundings place_surroundings(const SurroundingsOptions& options, const Bin& bin,
                                      const std::vector<PlacedTube>& tubes, const std::vector<Scanner>& scanners,
                                      Random& random);

/// "tube 3 reaches box 1 beside the bin", where it does by the same rule without clearance; empty where no tube does.
std::string find_touching_tube(const Surroundings& surroundings, const Bin& bin, const std::vector<PlacedTube>& tubes);

}  // namespace tubebin::scene
