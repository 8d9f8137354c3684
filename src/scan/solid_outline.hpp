// Where in the image a solid may appear.
#pragma once

#include "scan/scene_solids.hpp"
#include "tubebin/scene/camera.hpp"

namespace tubebin::scan {

/// Depth of the box's nearest corner, metres; the box is in world axes with its origin at the scanner.
double nearest_depth(const scene::Box& box, const scene::Camera& camera);

/// Whether one of the tube's solids reaches before the depth (metres).
bool begins_before(const SceneSolids& tube, const scene::Camera& camera, double depth);

/// Whether one of them reaches beyond it.
bool ends_beyond(const SceneSolids& tube, const scene::Camera& camera, double depth);

/// Whether a ray may pass through an open end.
bool is_hollow(const SceneSolids& tube);

/// Each tube's own solids, without the bin.
std::vector<SceneSolids> solids_by_tube(const scene::Scene& scene, const SceneSolids& all);

/// The columns [begin, end) of a row in which a solid may appear.
struct Columns {
  int begin = 0;
  int end = 0;
};

/// The pixels in which a cylinder may appear: the hull of two rectangles, those of the balls around its ends.
class CylinderOutline {
 public:
  CylinderOutline(const SolidCylinder& cylinder, const scene::Camera& camera, double depth_min);

  const scene::PixelWindow& window() const { return whole_; }
  Columns columns(int row) const;

 private:
  scene::PixelWindow whole_;
  scene::PixelWindow base_;
  scene::PixelWindow top_;
  bool is_hull_ = false;
};

/// The pixels in which a box may appear.
class BoxOutline {
 public:
  BoxOutline(const SolidBox& box, const scene::Camera& camera, double depth_min);

  const scene::PixelWindow& window() const { return window_; }
  Columns columns(int) const { return {window_.x, window_.x + window_.width}; }

 private:
  scene::PixelWindow window_;
};

/// The pixels in which a ball may appear.
class SphereOutline {
 public:
  SphereOutline(const SolidSphere& sphere, const scene::Camera& camera, double depth_min);

  const scene::PixelWindow& window() const { return window_; }
  Columns columns(int) const { return {window_.x, window_.x + window_.width}; }

 private:
  scene::PixelWindow window_;
};

}  // namespace tubebin::scan
