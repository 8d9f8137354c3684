#include "tubebin/scene/scanner_effects.hpp"

namespace tubebin::scene {
namespace {

constexpr Limits kShare = {0.0, 1.0};
constexpr Limits kReflectivity = {0.001, 1.0};
constexpr Limits kFieldDegrees = {0.1, 170.0};

void describe(Fields& fields, RangeNoise& noise) {
  fields.number("sigma", noise.sigma, {0.0, 0.1}, "m",
                "standard deviation of the depth at the reference distance, head-on; 0: off");
  fields.number("incidence_gain", noise.incidence_gain, {0.0, 10.0}, "",
                "how much it grows with the incidence angle; 0: not at all");
  fields.number("correlation_length", noise.correlation_length, {0.0, 100.0}, "pixels",
                "where the correlation between pixels has fallen to 1/e; 0: every pixel for itself");
}

void describe(Fields& fields, ProjectorOptions& projector) {
  fields.flag("enabled", projector.enabled, "points that the projector does not reach are missing");
  fields.vector("position", projector.position, {-100.0, 100.0}, "m",
                "of the projector in the scanner's frame: x to the right of the image, y down, z along the view");
  fields.number("focus_distance", projector.focus_distance, {0.01, 1000.0}, "m",
                "where the projector's optical axis meets the camera's");
  fields.number("horizontal_fov_deg", projector.horizontal_fov_deg, kFieldDegrees, "degrees", "of its field");
  fields.number("vertical_fov_deg", projector.vertical_fov_deg, kFieldDegrees, "degrees", "of its field");
}

void describe(Fields& fields, DropOuts& dropouts) {
  fields.number("signal_min", dropouts.signal_min, kShare, "",
                "weakest signal that gives a point; 1 is a white surface head-on at the reference distance; 0: off");
  fields.number("signal_spread", dropouts.signal_spread, {0.0, 10.0}, "",
                "standard deviation of the logarithm of a pixel's signal; 0: a sharp threshold");
  fields.number("tube_reflectivity_min", dropouts.tube_reflectivity_min, kReflectivity, "",
                "each tube has its own, uniform from here");
  fields.number("tube_reflectivity_max", dropouts.tube_reflectivity_max, kReflectivity, "", "to here");
  fields.number("bin_reflectivity", dropouts.bin_reflectivity, kReflectivity, "", "of floor and walls");
  fields.number("tube_glare_angle_deg", dropouts.tube_glare_angle_deg, {0.0, 90.0}, "degrees",
                "nearer than this to the mirror direction tubes are too bright; 0: off");
  fields.number("bin_glare_angle_deg", dropouts.bin_glare_angle_deg, {0.0, 90.0}, "degrees",
                "nearer than this to the mirror direction the bin is too bright; 0: off");
}

void describe(Fields& fields, MixedPixels& mixed) {
  fields.number("share", mixed.share, kShare, "",
                "of the pixels at depth edges whose point lies between the surfaces, with the nearer one's label; "
                "0: off");
  fields.number("footprint", mixed.footprint, {0.01, 10.0}, "pixels", "side of the square that a pixel sees");
  fields.number("edge_step", mixed.edge_step, {0.0, 10.0}, "m", "of depth within the footprint that makes an edge");
}

void describe(Fields& fields, Outliers& outliers) {
  fields.number("share", outliers.share, kShare, "", "of the points that lie anywhere near their ray; 0: off");
  fields.number("spread", outliers.spread, {0.0, 10.0}, "m", "of depth to either side of the surface, uniform");
}

void describe(Fields& fields, CalibrationError& error) {
  fields.vector("position", error.position, {-1.0, 1.0}, "m", "of the camera that places the points, scanner's frame");
  fields.vector("rotation_deg", error.rotation_deg, {-10.0, 10.0}, "degrees",
                "about the scanner's x, y and z axes, in that order");
  fields.number("focal", error.focal, {-0.1, 0.1}, "", "of the focal length, relative");
}

}  // namespace

bool ScannerEffects::any() const {
  const CalibrationError& error = calibration;
  return range_noise.sigma > 0.0 || lateral_noise > 0.0 || quantization > 0.0 || projector.enabled ||
         dropouts.signal_min > 0.0 || dropouts.tube_glare_angle_deg > 0.0 || dropouts.bin_glare_angle_deg > 0.0 ||
         mixed_pixels.share > 0.0 || outliers.share > 0.0 || !error.position.isZero(0.0) ||
         !error.rotation_deg.isZero(0.0) || error.focal != 0.0;
}

void describe(Fields& fields, ScannerEffects& effects) {
  fields.number("reference_distance", effects.reference_distance, {0.01, 1000.0}, "m",
                "depth at which noise and quantization, and distance at which the signal, have the values given");
  fields.group("range_noise", "of the depth", [&](Fields& inner) { describe(inner, effects.range_noise); });
  fields.number("lateral_noise", effects.lateral_noise, {0.0, 10.0}, "pixels",
                "standard deviation, along each image axis, of where a pixel looks; 0: off");
  fields.number("quantization", effects.quantization, {0.0, 0.1}, "m",
                "depth step at the reference distance, growing with the square of the depth; 0: off");
  fields.group("projector", "the light beside the camera", [&](Fields& inner) { describe(inner, effects.projector); });
  fields.group("dropouts", "too little light comes back, or too much",
               [&](Fields& inner) { describe(inner, effects.dropouts); });
  fields.group("mixed_pixels", "pixels that see two surfaces",
               [&](Fields& inner) { describe(inner, effects.mixed_pixels); });
  fields.group("outliers", "points off every surface", [&](Fields& inner) { describe(inner, effects.outliers); });
  fields.group("calibration", "error of the camera that places the points in the world",
               [&](Fields& inner) { describe(inner, effects.calibration); });
}

void check(const ScannerEffects& effects, const KeyPlaces& places, const std::string& prefix) {
  const DropOuts& dropouts = effects.dropouts;
  if (dropouts.tube_reflectivity_max < dropouts.tube_reflectivity_min)
    places.fail(prefix + ".dropouts.tube_reflectivity_max",
                fmt::format("{} is below tube_reflectivity_min = {}", dropouts.tube_reflectivity_max,
                            dropouts.tube_reflectivity_min));
  if (effects.projector.enabled && effects.projector.position.z() >= effects.projector.focus_distance)
    places.fail(prefix + ".projector.focus_distance",
                fmt::format("{} m is not beyond the projector's own depth, {} m", effects.projector.focus_distance,
                            effects.projector.position.z()));
}

}  // namespace tubebin::scene
