/// What the modeler is given: positions and where they were seen from. Colours and labels have no place here, so it
/// cannot peek at the ground truth.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/scene/scene.hpp"

namespace tubebin::modeling {

struct ModelingInput {
  std::span<const cloud::Point> points;               ///< metres, world frame; not finite where a pixel hit nothing
  Pose world_from_sensor = Pose::Identity();          ///< sensor frame: z along the view
  std::vector<Pose> world_from_further_sensors = {};  ///< of sources 1, 2, ... of a merged cloud
  std::span<const std::uint32_t> sources = {};        ///< of each point, the sensor that saw it; none: all the first
  std::optional<scene::Bin> bin;  ///< the known bin; without it, floor and walls are found in the cloud
  Pose world_from_bin = Pose::Identity();
  std::uint32_t width = 0;  ///< of an organized cloud, whose points stand row by row; 0: in any order
};

}  // namespace tubebin::modeling
