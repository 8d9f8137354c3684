/// The frame and the unit of a scene's cloud file. In memory clouds are in the world frame and in metres.
#pragma once

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/core/fields.hpp"

namespace tubebin::scene {

struct CloudSpace {
  enum class Frame {
    world,
    camera  ///< of the scanner, the first of several: x to the right of the image, y down, z along the view
  };
  enum class Unit { m, mm };

  Frame frame = Frame::world;
  Unit unit = Unit::m;

  double metres_per_unit() const { return unit == Unit::mm ? 1e-3 : 1.0; }

  friend bool operator==(const CloudSpace&, const CloudSpace&) = default;
};

void describe(Fields& fields, CloudSpace& space);

/// A cloud in the world frame and metres, as its file has it. Points are rounded to float anew.
cloud::Cloud in_space(cloud::Cloud cloud, const CloudSpace& space);

/// The cloud of a file in that space, read in metres (parse_cloud takes metres_per_unit), in the world frame.
cloud::Cloud in_world(cloud::Cloud cloud, const CloudSpace& space, const Pose& world_from_scanner);

}  // namespace tubebin::scene
