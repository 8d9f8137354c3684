// One cloud of several scanners.
#include "tubebin/core/random.hpp"
#include "tubebin/scan/scanner.hpp"

namespace tubebin::scan {
namespace {

/// Pixels without a point go, since the cloud is no image.
void append_points(const cloud::Cloud& from, std::uint32_t source, cloud::Cloud& to) {
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (!cloud::is_finite(from.points[i])) continue;
    to.points.push_back(from.points[i]);
    to.colors.push_back(from.colors[i]);
    to.labels.push_back(from.labels[i]);
    to.sources.push_back(source);
  }
  to.width = static_cast<std::uint32_t>(to.size());
}

/// Each scanner errs in its own way; source 0 as it would alone.
std::uint64_t source_seed(std::uint64_t seed, std::uint32_t source) {
  return source == 0 ? seed : derive_seed({seed, source});
}

/// `scene`: as the source sees it.
Scan scan_from(std::uint32_t source, const scene::Scene& scene, std::uint64_t seed,
               const std::vector<Scan>& bins_alone) {
  seed = source_seed(seed, source);
  return bins_alone.empty() ? scan(scene, seed) : scan(scene, seed, bins_alone.at(source));
}

}  // namespace

MergedScan scan_from_all(const scene::Scene& scene, std::uint64_t seed, const std::vector<Scan>& bins_alone) {
  if (scene.further_scanners.empty()) return {scan_from(0, scene, seed, bins_alone), {}};
  MergedScan merged;
  merged.tube_pixels.assign(scene.tubes.size(), 0);
  for (std::uint32_t source = 0; source < scene.source_count(); ++source) {
    const Scan part = scan_from(source, seen_from(scene, source), seed, bins_alone);
    append_points(part.cloud, source, merged.cloud);
    for (std::size_t k = 0; k < part.tube_pixels.size(); ++k) merged.tube_pixels[k] += part.tube_pixels[k];
    if (source == 0) {
      merged.window = part.window;
      merged.cloud.world_from_sensor = part.cloud.world_from_sensor;
    } else {
      merged.further_windows.push_back(part.window);
    }
  }
  return merged;
}

MergedScan scan_exactly_from_all(scene::Scene scene, const std::vector<Scan>& bins_alone) {
  scene.scanner.effects = {};
  for (scene::Scanner& scanner : scene.further_scanners) scanner.effects = {};
  return scan_from_all(scene, 0, bins_alone);
}

std::vector<Scan> scan_bin_alone(const scene::Scene& scene) {
  std::vector<Scan> scans;
  for (std::size_t source = 0; source < scene.source_count(); ++source) {
    scene::Scene bin = seen_from(scene, source);
    bin.tubes.clear();
    bin.surroundings.reset();
    bin.scanner.effects = {};
    bin.scanner.region = scene::ScanRegion::bin;
    scans.push_back(scan(bin));
  }
  return scans;
}

}  // namespace tubebin::scan
