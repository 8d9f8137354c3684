#include "scan/measurement.hpp"

#include <algorithm>
#include <cmath>

#include "scan/surface_normal.hpp"

namespace tubebin::scan {
namespace {

/// The growth has a pole at 90 degrees, and nobody has measured it beyond.
const double kSteepestIncidence = radians(85.0);

double square(double x) { return x * x; }

}  // namespace

double incidence_growth(double incidence, double gain) {
  const double angle = std::min(incidence, kSteepestIncidence);
  return 1.0 + gain * square(angle / (std::numbers::pi / 2.0 - angle));
}

double quantize_depth(double depth, double step, double reference_distance) {
  const double disparity_step = step / square(reference_distance);
  return 1.0 / (std::max(1.0, std::round(1.0 / (depth * disparity_step))) * disparity_step);
}

Reconstruction::Reconstruction(const scene::Scanner& scanner)
    : scanner_(scanner),
      focal_length_(scene::Camera(scanner).focal_length() * (1.0 + scanner.effects.calibration.focal)) {
  const scene::CalibrationError& error = scanner.effects.calibration;
  const Quat rotation = Eigen::AngleAxisd(radians(error.rotation_deg.z()), Vec3::UnitZ()) *
                        Eigen::AngleAxisd(radians(error.rotation_deg.y()), Vec3::UnitY()) *
                        Eigen::AngleAxisd(radians(error.rotation_deg.x()), Vec3::UnitX());
  world_from_camera_ = scanner.world_from_scanner() * make_pose(rotation, error.position);
}

Vec3 Reconstruction::point_in_world(int column, int row, double depth) const {
  const double x = (column + 0.5 - scanner_.width / 2.0) / focal_length_;
  const double y = (row + 0.5 - scanner_.height / 2.0) / focal_length_;
  return world_from_camera_ * Vec3(depth * x, depth * y, depth);
}

Measurement::Measurement(const scene::Scene& scene, const RayCaster& caster, const scene::Camera& camera,
                         const scene::PixelWindow& window, std::uint64_t seed)
    : effects_(scene.scanner.effects), caster_(caster), camera_(camera), window_(window), seed_(seed) {
  if (effects_.projector.enabled) projector_.emplace(scene);
  if (effects_.range_noise.sigma > 0.0)
    range_normals_ = correlated_normals(noise(NoiseStream::range), window, effects_.range_noise.correlation_length);
}

std::optional<Hit> Measurement::measure(int column, int row) const {
  const std::optional<Surface> surface = find_surface(column, row);
  if (!surface || (projector_ && !projector_->reaches(surface->p_in_world)) || !gives_signal(*surface, column, row))
    return std::nullopt;
  Hit measured = mixed_pixel_hit(*surface, column, row);
  measured.depth += range_noise(*surface, measured.depth, column, row) + outlier_offset(column, row);
  if (!(measured.depth > 0.0)) return std::nullopt;
  if (effects_.quantization > 0.0)
    measured.depth = quantize_depth(measured.depth, effects_.quantization, effects_.reference_distance);
  return measured;
}

std::optional<Measurement::Surface> Measurement::find_surface(int column, int row) const {
  Surface surface;
  surface.image_position = {column + 0.5, row + 0.5};
  if (effects_.lateral_noise > 0.0)
    surface.image_position +=
        effects_.lateral_noise * Eigen::Vector2d(noise(NoiseStream::lateral_x).normal(column, row),
                                                 noise(NoiseStream::lateral_y).normal(column, row));
  const double x = surface.image_position.x(), y = surface.image_position.y();
  const Vec3 direction = camera_.direction_in_world(x, y);
  surface.hit = caster_.first_hit(direction);
  if (!surface.hit.found()) return std::nullopt;
  surface.p_in_world = camera_.world_from_scanner().translation() + surface.hit.depth * direction;
  surface.normal = surface_normal(caster_, camera_, x, y, surface.hit);
  surface.to_view = -direction.normalized();
  return surface;
}

/// Light that a matt surface returns, and the mirror image of the lamp on a shiny one.
bool Measurement::gives_signal(const Surface& surface, int column, int row) const {
  const scene::DropOuts& dropouts = effects_.dropouts;
  const Vec3 lamp = projector_ ? projector_->position_in_world() : Vec3(camera_.world_from_scanner().translation());
  const double distance = (lamp - surface.p_in_world).norm();
  const Vec3 to_lamp = (lamp - surface.p_in_world) / distance;
  const double glare_deg = surface.hit.label == 0 ? dropouts.bin_glare_angle_deg : dropouts.tube_glare_angle_deg;
  if (glare_deg > 0.0 && angle_between(surface.normal, (to_lamp + surface.to_view).normalized()) < radians(glare_deg))
    return false;
  if (dropouts.signal_min <= 0.0) return true;
  const double signal = reflectivity(surface.hit.label) * std::max(0.0, surface.normal.dot(to_lamp)) *
                        square(effects_.reference_distance / distance);
  const double spread = dropouts.signal_spread;
  return signal * std::exp(spread > 0.0 ? spread * noise(NoiseStream::signal).normal(column, row) : 0.0) >=
         dropouts.signal_min;
}

double Measurement::reflectivity(cloud::Label label) const {
  const scene::DropOuts& dropouts = effects_.dropouts;
  if (label == 0) return dropouts.bin_reflectivity;
  return dropouts.tube_reflectivity_min + (dropouts.tube_reflectivity_max - dropouts.tube_reflectivity_min) *
                                              noise(NoiseStream::tube_reflectivity).uniform(static_cast<int>(label), 0);
}

/// The footprint's corners and middle stand for its area.
Hit Measurement::mixed_pixel_hit(const Surface& surface, int column, int row) const {
  const scene::MixedPixels& mixed = effects_.mixed_pixels;
  if (mixed.share <= 0.0 || noise(NoiseStream::mixed_pixels).uniform(column, row) >= mixed.share) return surface.hit;
  Hit nearest = surface.hit;
  double farthest = surface.hit.depth, sum = surface.hit.depth;
  int seen = 1;
  for (const Eigen::Vector2d& corner : {Eigen::Vector2d(-0.5, -0.5), {0.5, -0.5}, {-0.5, 0.5}, {0.5, 0.5}}) {
    const Eigen::Vector2d at = surface.image_position + mixed.footprint * corner;
    const Hit hit = caster_.first_hit(camera_.direction_in_world(at.x(), at.y()));
    if (!hit.found()) continue;
    if (hit.depth < nearest.depth) nearest = hit;
    farthest = std::max(farthest, hit.depth);
    sum += hit.depth;
    ++seen;
  }
  if (farthest - nearest.depth < mixed.edge_step) return surface.hit;
  return {sum / seen, nearest.label};
}

double Measurement::range_noise(const Surface& surface, double depth, int column, int row) const {
  const scene::RangeNoise& range = effects_.range_noise;
  if (range.sigma <= 0.0) return 0.0;
  const auto index = static_cast<std::size_t>(row - window_.y) * static_cast<std::size_t>(window_.width) +
                     static_cast<std::size_t>(column - window_.x);
  return range.sigma * square(depth / effects_.reference_distance) *
         incidence_growth(angle_between(surface.normal, surface.to_view), range.incidence_gain) * range_normals_[index];
}

double Measurement::outlier_offset(int column, int row) const {
  const scene::Outliers& outliers = effects_.outliers;
  if (outliers.share <= 0.0 || noise(NoiseStream::outlier_choice).uniform(column, row) >= outliers.share) return 0.0;
  return outliers.spread * (2.0 * noise(NoiseStream::outlier_depth).uniform(column, row) - 1.0);
}

}  // namespace tubebin::scan
