// What of one pixel's bodies is in front.
#pragma once

#include <variant>

#include "scan/ray_caster.hpp"
#include "tubebin/scene/camera.hpp"

namespace tubebin::scan {

/// A body's surface that a pixel's ray meets.
struct Layer {
  cloud::Label label = 0;
  double depth = 0.0;

  /// At equal depths the lower label is in front, as in scan().
  bool is_before(const Layer& other) const {
    return depth < other.depth || (depth == other.depth && label < other.label);
  }
};

/// The bin, and what stands around it, as far as they can stand before something.
class BinFront {
 public:
  struct Part {
    std::variant<SolidBox, SolidCylinder, const MeshCaster*> solid;
    scene::PixelWindow window;
    double nearest_depth = 0.0;
  };

  BinFront(const scene::Scene& scene, const scene::Camera& camera);

  const std::vector<Part>& parts() const { return parts_; }
  /// Their first surface along the pixel's ray, if it may be before `depth`; else infinity.
  double first_before(double depth, int column, int row);

 private:
  const scene::Camera& camera_;
  double depth_min_;
  std::unique_ptr<MeshCaster> mesh_;
  std::vector<Part> parts_;
  std::vector<Interval> inside_;
};

}  // namespace tubebin::scan
