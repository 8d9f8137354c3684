#include "tubebin/scene/cloud_space.hpp"

namespace tubebin::scene {
namespace {

/// Not finite where the point isn't.
void transform(cloud::Cloud& cloud, const Eigen::Affine3d& to_from) {
  for (cloud::Point& point : cloud.points) point = (to_from * point.cast<double>()).cast<float>();
}

}  // namespace

void describe(Fields& fields, CloudSpace& space) {
  fields.choice("frame", space.frame, {"world", "camera"},
                "frame of the clouds: the world's, or the scanner's (x right, y down, z along the view; the first of "
                "several), with VIEWPOINT at its origin");
  fields.choice("unit", space.unit, {"m", "mm"}, "unit of the clouds' coordinates, and of their VIEWPOINT");
}

cloud::Cloud in_space(cloud::Cloud cloud, const CloudSpace& space) {
  if (space == CloudSpace{}) return cloud;
  const double units = 1.0 / space.metres_per_unit();
  Eigen::Affine3d file_from_world(Eigen::Scaling(units));
  if (space.frame == CloudSpace::Frame::camera) {
    file_from_world = file_from_world * cloud.world_from_sensor.inverse();
    cloud.world_from_sensor = Pose::Identity();
  }
  transform(cloud, file_from_world);
  cloud.world_from_sensor.translation() *= units;
  return cloud;
}

cloud::Cloud in_world(cloud::Cloud cloud, const CloudSpace& space, const Pose& world_from_scanner) {
  if (space.frame == CloudSpace::Frame::world) return cloud;
  transform(cloud, Eigen::Affine3d(world_from_scanner));
  cloud.world_from_sensor = world_from_scanner;
  return cloud;
}

}  // namespace tubebin::scene
