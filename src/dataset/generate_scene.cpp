#include "tubebin/dataset/generate_scene.hpp"

#include <algorithm>

#include "dataset/pile.hpp"
#include "dataset/stage_clock.hpp"
#include "tubebin/cloud/label_colors.hpp"
#include "tubebin/render/preview.hpp"
#include "tubebin/scan/visibility.hpp"
#include "tubebin/scene/depth_image.hpp"

namespace tubebin::dataset {
namespace {

constexpr int kPreviewWidth = 1280;
constexpr int kPreviewHeight = 960;

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

GeneratedScene show_pile(const Piles& piles, const SceneId& id, const std::vector<scan::Scan>& bins_alone) {
  const DatasetConfig& config = piles.config;
  const Pile& pile = piles.piles[static_cast<std::size_t>(std::max(id.step, 0))];
  GeneratedScene result;
  result.seconds = pile.seconds;
  result.physics = pile.rest.figures;
  StageClock clock(result.seconds);
  const scene::Scene scene = scene_of(config, pile);
  scan::MergedScan scanned = scan::scan_from_all(scene, pile.seed, bins_alone);
  clock.end_stage("scan");
  if (!has_point(scanned.cloud)) {
    result.failure = "unseen";
    result.failure_detail = fmt::format(
        "the cloud has no point: from scanner.position, with scanner.rotation_deg, no surface lies between range_min "
        "{} m and range_max {} m in the image",
        scene.scanner.range_min, scene.scanner.range_max);
    return result;
  }
  scene::PileRelations relations = relate_pile(scene);
  clock.end_stage("relate");

  result.content.record = {.id = id.name(),
                           .seed = pile.seed,
                           .scene = scene,
                           .window = scanned.window,
                           .colors = cloud::label_colors(scene.tubes.size()),
                           .tube_pixels = std::move(scanned.tube_pixels),
                           .contacts = pile.rest.contacts,
                           .further_windows = std::move(scanned.further_windows),
                           .relations = std::move(relations),
                           .space = config.output.space,
                           .drawn = piles.drawn,
                           .lift = pile.lift};
  result.content.cloud = std::move(scanned.cloud);
  if (config.output.clean_cloud) {
    result.content.clean_cloud = scan::scan_exactly_from_all(scene, bins_alone).cloud;
    clock.end_stage("clean_cloud");
  }

  if (config.output.depth_image) {
    const scene::DepthImage image = scene::depth_image(result.content.cloud, result.content.record);
    result.content.record.depth_mm_per_unit = image.mm_per_unit;
    result.content.images = scene::format_depth_image(image);
    clock.end_stage("depth_image");
  }

  if (config.output.preview) {
    const render::Image preview = render::render_preview(scene, kPreviewWidth, kPreviewHeight);
    result.content.images["preview.png"] = render::encode_png(preview);
    result.content.images["ground_truth.png"] = render::encode_png(render::render_labels(scene, scanned.window));
    clock.end_stage("preview");
  }
  return result;
}

GeneratedScene generate_scene(const DatasetConfig& config, const SceneId& id, int attempt) {
  const Piles made = make_piles(config, id, attempt, std::max(id.step, 0));
  if (made.failure.empty()) return show_pile(made, id, {});
  GeneratedScene result;
  result.failure = made.failure;
  result.failure_detail = made.failure_detail;
  result.physics = made.physics;
  return result;
}

}  // namespace tubebin::dataset
