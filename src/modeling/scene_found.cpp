#include "modeling/scene_found.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace tubebin::modeling {

std::string place_text(const Vec3& p) { return fmt::format("({:.3f}, {:.3f}, {:.3f})", p.x(), p.y(), p.z()); }

void describe_scene(const Background& background, const ViewProjection& projection, const Vec3& told_up,
                    SceneFound& found) {
  found.viewpoint = projection.viewpoint().cast<double>();
  found.flat_regions = background.regions.size();
  const auto support = std::ranges::find_if(background.regions, &FlatRegion::is_solid);
  if (support != background.regions.end()) {
    found.up = support->plane.normal;
    found.up_is_known = true;
  }
  if (told_up.isZero()) return;
  if (found.up_is_known && found.up.dot(told_up.normalized()) < 0.8)
    found.doubts.push_back(fmt::format(
        "the largest support looks along ({:.2f}, {:.2f}, {:.2f}), not along the up direction that was told",
        found.up.x(), found.up.y(), found.up.z()));
  found.up = told_up.normalized();
  found.up_is_known = true;
}

std::string describe_found(const ModelingResult& result) {
  const SceneFound& found = result.found;
  std::string radii;
  for (std::size_t k = 0; k < result.radii.size(); ++k)
    radii +=
        fmt::format("{}{:.2f} +- {:.2f} mm", k > 0 ? ", " : "", result.radii[k] * 1e3, result.radius_errors[k] * 1e3);
  const std::string length =
      result.lengths.empty() ? "not common" : fmt::format("{:.3f} m", fmt::join(result.lengths, ", "));
  std::string viewpoints = place_text(found.viewpoint);
  for (const Vec3& further : found.further_viewpoints) viewpoints += ", " + place_text(further);
  const std::string bin =
      found.bin ? fmt::format("bin {:.3f} x {:.3f} x {:.3f} m", found.bin->length, found.bin->width, found.bin->height)
                : std::string("no bin");
  const std::string smoothed = found.noise_smoothed > 0.0
                                   ? fmt::format("noise of {:.2f} mm smoothed; ", found.noise_smoothed * 1e3)
                                   : std::string();
  const std::string mesh = found.wire_radius > 0.0
                               ? fmt::format("mesh of wires of radius {:.2f} mm; ", found.wire_radius * 1e3)
                               : std::string();
  return fmt::format(
      "scene: radius {}; length {}; up {} ({:.2f}, {:.2f}, {:.2f}); viewpoint {}; {}{} flat regions; {}"
      "{}; {:.1f} % unexplained",
      radii.empty() ? "none" : radii, length, found.up_is_known ? "along" : "unknown, taken as", found.up.x(),
      found.up.y(), found.up.z(), viewpoints, smoothed, found.flat_regions, mesh, bin, 100.0 * found.unexplained);
}

namespace {

/// Tubes of a bin are mostly alike. One alone that is far thicker may be of something else.
void doubt_a_lone_thick_tube(const std::vector<TubeModel>& tubes, std::vector<std::string>& doubts) {
  constexpr double kFarThicker = 3.0;
  std::map<double, std::size_t> count_of_radius;
  for (const TubeModel& tube : tubes) ++count_of_radius[tube.radius];
  if (count_of_radius.empty()) return;
  const auto& [common, count] =
      *std::ranges::max_element(count_of_radius, {}, [](const auto& of) { return of.second; });
  for (const TubeModel& tube : tubes)
    if (count_of_radius[tube.radius] == 1 && tube.length() > 0.0 && tube.radius > kFarThicker * common)
      doubts.push_back(fmt::format(
          "one tube alone has a radius of {:.2f} mm, and {} have {:.2f} mm: it may be part of a robot, or a bottle",
          tube.radius * 1e3, count, common * 1e3));
}

}  // namespace

void add_doubts(ModelingResult& result, bool radii_are_told) {
  auto& doubts = result.found.doubts;
  constexpr double kWidestTube = 0.3;  // metres
  if (result.tubes.empty())
    doubts.push_back("nothing in the cloud is round like a tube, of any radius from 3 to 40 spacings of its points");
  for (const double radius : result.radii)
    if (radius > kWidestTube)
      doubts.push_back(
          fmt::format("a radius of {:.3g} m: is the cloud in another unit (--scale 0.001 for millimetres)?", radius));
  if (!result.tubes.empty() && result.found.unexplained > 1.0 / 3.0)
    doubts.push_back(
        fmt::format("{:.0f} % of the points that are not flat lie on no tube", 100.0 * result.found.unexplained));
  if (!radii_are_told) doubt_a_lone_thick_tube(result.tubes, doubts);
}

}  // namespace tubebin::modeling
