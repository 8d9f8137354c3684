// What a scanner with effects makes of the surfaces before it, pixel by pixel (docs/scanner_effects.md).
#pragma once

#include <optional>

#include "scan/pixel_noise.hpp"
#include "scan/projector.hpp"
#include "tubebin/scene/camera.hpp"

namespace tubebin::scan {

/// Growth of the range noise with the incidence angle (radians), 1 head-on.
double incidence_growth(double incidence, double gain);

/// The depth (metres) on the grid whose step is `step` at `reference_distance` and grows with the depth's square.
double quantize_depth(double depth, double step, double reference_distance);

/// The camera that places points in the world, with its calibration error.
class Reconstruction {
 public:
  explicit Reconstruction(const scene::Scanner& scanner);
  Vec3 point_in_world(int column, int row, double depth) const;

 private:
  const scene::Scanner& scanner_;
  double focal_length_;  ///< pixels
  Pose world_from_camera_;
};

class Measurement {
 public:
  /// `window`: the pixels that will be asked for.
  Measurement(const scene::Scene& scene, const RayCaster& caster, const scene::Camera& camera,
              const scene::PixelWindow& window, std::uint64_t seed);

  /// Depth (metres, as measured) and label of a pixel; nothing where it gives no point.
  std::optional<Hit> measure(int column, int row) const;

 private:
  struct Surface {
    Eigen::Vector2d image_position;  ///< where the pixel looks
    Hit hit;
    Vec3 p_in_world;
    Vec3 normal;   ///< unit, world axes, towards the camera
    Vec3 to_view;  ///< unit, towards the camera
  };

  std::optional<Surface> find_surface(int column, int row) const;
  bool gives_signal(const Surface& surface, int column, int row) const;
  Hit mixed_pixel_hit(const Surface& surface, int column, int row) const;
  double range_noise(const Surface& surface, double depth, int column, int row) const;
  double outlier_offset(int column, int row) const;
  double reflectivity(cloud::Label label) const;
  PixelNoise noise(NoiseStream stream) const { return {seed_, stream}; }

  const scene::ScannerEffects& effects_;
  const RayCaster& caster_;
  const scene::Camera& camera_;
  scene::PixelWindow window_;
  std::uint64_t seed_;
  std::optional<Projector> projector_;
  std::vector<double> range_normals_;  ///< of the window's pixels
};

}  // namespace tubebin::scan
