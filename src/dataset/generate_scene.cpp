#include "tubebin/dataset/generate_scene.hpp"

#include <algorithm>
#include <chrono>

#include "tubebin/cloud/label_colors.hpp"
#include "tubebin/render/preview.hpp"
#include "tubebin/scan/scanner.hpp"
#include "tubebin/scan/visibility.hpp"

namespace tubebin::dataset {
namespace {

constexpr int kPreviewWidth = 1280;
constexpr int kPreviewHeight = 960;

std::string png(const render::Image& image) {
  const std::vector<std::uint8_t> bytes = render::encode_png(image);
  return {bytes.begin(), bytes.end()};
}

/// Adds the time since the last call to the named stage.
class StageClock {
 public:
  explicit StageClock(std::map<std::string, double>& seconds) : seconds_(seconds) {}
  void end_stage(const char* name) {
    const auto now = std::chrono::steady_clock::now();
    seconds_[name] += std::chrono::duration<double>(now - start_).count();
    start_ = now;
  }

 private:
  std::map<std::string, double>& seconds_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

bool has_point(const cloud::Cloud& cloud) {
  return std::any_of(cloud.points.begin(), cloud.points.end(), cloud::is_finite);
}

}  // namespace

scene::PileRelations relate_pile(const scene::Scene& scene) {
  scan::PileView view = scan::view_pile(scene);
  return {.amodal_pixels = std::move(view.amodal_pixels),
          .occlusions = std::move(view.occlusions),
          .above = scene::find_above(scene.tubes)};
}

std::uint64_t attempt_seed(const DatasetConfig& config, const SceneId& id, int attempt) {
  std::uint64_t set = 0;
  for (const char letter : id.set) set = derive_seed({set, static_cast<std::uint64_t>(letter)});
  return derive_seed({config.seed, set, static_cast<std::uint64_t>(id.tubes),
                      static_cast<std::uint64_t>(id.case_number), static_cast<std::uint64_t>(attempt)});
}

GeneratedScene generate_scene(const DatasetConfig& config, const SceneId& id, int attempt) {
  GeneratedScene result;
  StageClock clock(result.seconds);
  Random random(attempt_seed(config, id, attempt));

  const std::vector<tube::Tube> tubes = config.kinds.empty()
                                            ? tube::generate_tubes(id.tubes, config.tube, random)
                                            : tube::generate_mixed_tubes(id.tubes, config.kinds, random);
  clock.end_stage("build");

  physics::DropResult drop = physics::drop_tubes(tubes, config.bin, config.physics, random.bits());
  clock.end_stage("drop");
  result.physics = drop.figures;
  if (drop.failure != physics::DropFailure::none) {
    result.failure = to_string(drop.failure);
    result.failure_detail = drop.detail;
    return result;
  }

  const std::vector<scene::Scanner> scanners = config.all_scanners();
  const scene::Scene scene{.bin = config.bin,
                           .scanner = scanners.front(),
                           .tubes = std::move(drop.tubes),
                           .further_scanners = {scanners.begin() + 1, scanners.end()}};
  scan::MergedScan scanned = scan::scan_from_all(scene, attempt_seed(config, id, attempt));
  clock.end_stage("scan");
  if (!has_point(scanned.cloud)) {
    result.failure = "unseen";
    result.failure_detail = fmt::format(
        "the cloud has no point: from scanner.position, with scanner.rotation_deg, no surface lies between range_min "
        "{} m and range_max {} m in the image",
        scanners.front().range_min, scanners.front().range_max);
    return result;
  }
  scene::PileRelations relations = relate_pile(scene);
  clock.end_stage("relate");

  result.content.record = {.id = id.name(),
                           .seed = attempt_seed(config, id, attempt),
                           .scene = scene,
                           .window = scanned.window,
                           .colors = cloud::label_colors(scene.tubes.size()),
                           .tube_pixels = std::move(scanned.tube_pixels),
                           .contacts = std::move(drop.contacts),
                           .further_windows = std::move(scanned.further_windows),
                           .relations = std::move(relations)};
  result.content.cloud = std::move(scanned.cloud);
  if (config.output.clean_cloud) {
    result.content.clean_cloud = scan::scan_exactly_from_all(scene).cloud;
    clock.end_stage("clean_cloud");
  }

  if (config.output.preview) {
    result.content.images["preview.png"] = png(render::render_preview(scene, kPreviewWidth, kPreviewHeight));
    result.content.images["ground_truth.png"] = png(render::render_labels(scene, scanned.window));
    clock.end_stage("preview");
  }
  return result;
}

}  // namespace tubebin::dataset
