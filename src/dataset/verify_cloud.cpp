#include "dataset/verify_cloud.hpp"

#include <fmt/ranges.h>

#include <algorithm>

#include "dataset/surface_distance.hpp"
#include "tubebin/scan/scanner.hpp"

namespace tubebin::dataset {
namespace {

using Problems = std::vector<std::string>;

// Exactness of a noise-free scan: 0.005 mm.
constexpr double kSurfaceTolerance = 5e-6;

void check_sources(const cloud::Cloud& cloud, const scene::SceneRecord& scene, Problems& problems) {
  const std::size_t source_count = scene.scene.source_count();
  if (cloud.sources.size() != (source_count > 1 ? cloud.size() : 0))
    problems.push_back(fmt::format("{} of the cloud's {} points say which of {} scanners saw them",
                                   cloud.sources.size(), cloud.size(), source_count));
  else if (std::ranges::any_of(cloud.sources, [&](std::uint32_t source) { return source >= source_count; }))
    problems.push_back(fmt::format("the cloud has points of other sources than its {} scanners", source_count));
}

void check_cloud_layout(const cloud::Cloud& cloud, const scene::SceneRecord& scene, Problems& problems) {
  const bool is_organized = scene.scene.further_scanners.empty() &&
                            scene.scene.scanner.region != scene::ScanRegion::tubes &&
                            scene.window.width * scene.window.height > 0;
  if (is_organized && (cloud.width != static_cast<std::uint32_t>(scene.window.width) ||
                       cloud.height != static_cast<std::uint32_t>(scene.window.height)))
    problems.push_back(fmt::format("the cloud has {} x {} points, the window of scene.json {} x {}", cloud.width,
                                   cloud.height, scene.window.width, scene.window.height));
  if (cloud.colors.size() != cloud.size() || cloud.labels.size() != cloud.size())
    problems.push_back("the cloud has no colour or no label for each point");
  check_sources(cloud, scene, problems);
}

/// Labels and colours; that points lie on their surfaces where `exact` says so. Returns the tubes' pixels.
std::vector<std::size_t> check_points(const cloud::Cloud& cloud, const scene::SceneRecord& scene, bool exact,
                                      Problems& problems) {
  const std::vector<BodySurface> surfaces = surfaces_of(scene.scene);
  std::vector<std::size_t> pixels(surfaces.size(), 0);
  std::size_t unknown = 0, miscolored = 0, off_surface = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const cloud::Label label = cloud.labels[i];
    if (!cloud::is_finite(cloud.points[i])) {
      miscolored += label != 0 || cloud.colors[i] != cloud::kNullColor;
    } else if (label >= surfaces.size()) {
      ++unknown;
    } else {
      ++pixels[label];
      miscolored += cloud.colors[i] != scene.colors[label];
      off_surface += exact && !(surfaces[label].distance(cloud.points[i].cast<double>()) <= kSurfaceTolerance);
    }
  }
  if (unknown > 0) problems.push_back(fmt::format("{} points have labels of no tube", unknown));
  if (miscolored > 0) problems.push_back(fmt::format("{} points have another colour than their label", miscolored));
  if (off_surface > 0)
    problems.push_back(fmt::format("{} points lie more than {} mm off the surface of their label", off_surface,
                                   kSurfaceTolerance * 1e3));
  pixels.erase(pixels.begin());
  return pixels;
}

/// How many points are others than those of `expected`: of another label, missing, or farther off than exact surfaces
/// may be.
std::size_t count_differences(const cloud::Cloud& cloud, const cloud::Cloud& expected) {
  if (cloud.size() != expected.size()) return std::max(cloud.size(), expected.size());
  std::size_t differences = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const cloud::Point &found = cloud.points[i], &wanted = expected.points[i];
    const bool same_place = cloud::is_finite(wanted) ? (found - wanted).norm() <= static_cast<float>(kSurfaceTolerance)
                                                     : !cloud::is_finite(found);
    differences += !same_place || cloud.labels[i] != expected.labels[i] ||
                   (!expected.sources.empty() && cloud.sources[i] != expected.sources[i]);
  }
  return differences;
}

/// A cloud with effects is off the surfaces by design, by its seed's noise. So it is compared with what the seed gives,
/// and the surfaces with its noise-free twin.
void check_effects(const cloud::Cloud& cloud, const scene::SceneRecord& scene, Problems& problems) {
  if (const std::size_t differing = count_differences(cloud, scan::scan_from_all(scene.scene, scene.seed).cloud))
    problems.push_back(fmt::format("{} points are not what the scanner's effects make of the scene", differing));
  check_points(scan::scan_exactly_from_all(scene.scene).cloud, scene, true, problems);
}

}  // namespace

Problems check_cloud(const cloud::Cloud& cloud, const scene::SceneRecord& scene) {
  Problems problems;
  check_cloud_layout(cloud, scene, problems);
  if (!problems.empty()) return problems;
  bool has_effects = scene.scene.scanner.effects.any();
  for (const scene::Scanner& scanner : scene.scene.further_scanners) has_effects |= scanner.effects.any();
  const std::vector<std::size_t> pixels = check_points(cloud, scene, !has_effects, problems);
  if (pixels != scene.tube_pixels)
    problems.push_back(fmt::format("the cloud shows [{}] pixels of the tubes, scene.json says [{}]",
                                   fmt::join(pixels, ", "), fmt::join(scene.tube_pixels, ", ")));
  if (has_effects) check_effects(cloud, scene, problems);
  return problems;
}

Problems check_clean_cloud(const cloud::Cloud& clean, const scene::SceneRecord& scene) {
  Problems problems;
  check_cloud_layout(clean, scene, problems);
  if (!problems.empty()) return problems;
  check_points(clean, scene, true, problems);
  if (const std::size_t differing = count_differences(clean, scan::scan_exactly_from_all(scene.scene).cloud))
    problems.push_back(fmt::format("{} points of cloud_clean are not the scene as exact rays see it", differing));
  return problems;
}

Problems check_depth_image(const scene::DepthImage& found, const cloud::Cloud& cloud, const scene::SceneRecord& scene) {
  Problems problems;
  const scene::DepthImage expected = scene::depth_image(cloud, scene);
  if (found.mm_per_unit != expected.mm_per_unit)
    problems.push_back(fmt::format("scene.json has {} mm a unit of depth.png, its scanner's range gives {}",
                                   found.mm_per_unit, expected.mm_per_unit));
  // A cloud in the camera's frame or in millimetres was rounded anew: its depth may be one unit beside the image's.
  std::size_t differing = 0;
  for (std::size_t i = 0; i < expected.depths.size(); ++i)
    differing += std::abs(found.depths[i] - expected.depths[i]) > 1 || found.labels[i] != expected.labels[i];
  if (differing > 0)
    problems.push_back(fmt::format("{} pixels of depth.png or labels.png are not those of the cloud", differing));
  return problems;
}

}  // namespace tubebin::dataset
