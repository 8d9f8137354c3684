// Where the structured light falls.
#pragma once

#include "scan/ray_caster.hpp"

namespace tubebin::scan {

class Projector {
 public:
  /// The scene's scanner has one.
  explicit Projector(const scene::Scene& scene);

  const Vec3& position_in_world() const { return position_in_world_; }
  /// Whether the point, on a surface, lies in the field and nothing stands before it.
  bool reaches(const Vec3& p_in_world) const;

 private:
  Vec3 position_in_world_;
  Eigen::Matrix3d projector_from_world_;  ///< rotation; z is the optical axis
  double tan_half_width_;
  double tan_half_height_;
  RayCaster caster_;
};

}  // namespace tubebin::scan
