/// Objects around the bin: a table, boxes and cylinders that stand on it, further bins. All of them have label 0, as the bin.
/// World frame, metres.
#pragma once

#include <vector>

#include "tubebin/core/fields.hpp"

namespace tubebin::scene {

/// A solid box that stands upright.
struct StandingBox {
  Vec3 position = Vec3::Zero();  ///< of the middle of its lower face
  double yaw_deg = 0.0;          ///< degrees, about z
  Vec3 size = Vec3::Zero();      ///< along its own axes

  friend bool operator==(const StandingBox&, const StandingBox&) = default;
};

/// A solid cylinder that stands upright.
struct StandingCylinder {
  Vec3 position = Vec3::Zero();  ///< of the middle of its lower face
  double radius = 0.0;
  double height = 0.0;

  friend bool operator==(const StandingCylinder&, const StandingCylinder&) = default;
};

/// An empty bin of the same form as the one with the tubes.
struct StandingBin {
  Vec3 position = Vec3::Zero();  ///< of the centre of its floor
  double yaw_deg = 0.0;          ///< degrees, about z

  friend bool operator==(const StandingBin&, const StandingBin&) = default;
};

struct Surroundings {
  StandingBox table;  ///< the bin and all else stand on it
  std::vector<StandingBox> boxes;
  std::vector<StandingCylinder> cylinders;
  std::vector<StandingBin> bins;

  friend bool operator==(const Surroundings&, const Surroundings&) = default;
};

/// As scene.json has them.
void describe(Fields& fields, StandingBox& box);
void describe(Fields& fields, StandingCylinder& cylinder);
void describe(Fields& fields, StandingBin& bin);
void describe(Fields& fields, Surroundings& surroundings);

}  // namespace tubebin::scene
