#include "dataset/verify_settings.hpp"

#include <algorithm>

#include "dataset/randomization.hpp"

namespace tubebin::dataset {
namespace {

std::vector<KeyValue> values_of(scene::Scanner scanner) {
  if (!scanner.effects.any()) scanner.effects = {};  // as in files, which leave out what has no effect
  return list_fields([&](Fields& fields) {
    describe(fields, scanner);
    describe(fields, scanner.effects);
  });
}

bool has_scanners_of(const scene::Scene& scene, const DatasetConfig& config) {
  std::vector<scene::Scanner> scanners = {scene.scanner};
  scanners.insert(scanners.end(), scene.further_scanners.begin(), scene.further_scanners.end());
  return std::ranges::equal(scanners, config.all_scanners(), {}, values_of, values_of);
}

bool has_numbers_of(const tube::Tube& tube, const tube::Tube& expected) {
  return tube.drawn == expected.drawn && tube.radius == expected.radius && tube.mass == expected.mass &&
         tube.wall_thickness == expected.wall_thickness;
}

}  // namespace

std::vector<std::string> check_settings(const scene::SceneRecord& scene, const DatasetConfig& config) {
  std::vector<std::string> problems;
  if (!has_scanners_of(scene.scene, config)) problems.emplace_back("scene.json has other scanners than config.yaml");
  if (scene.space != config.output.space)
    problems.emplace_back("scene.json has another frame or unit of the cloud than config.yaml");
  if (scene.depth_mm_per_unit.has_value() != config.output.depth_image)
    problems.emplace_back("scene.json has a depth image where config.yaml has none, or none where it has one");
  if (config.distributions.empty() || scene.lift) return problems;
  if (scene.drawn != draw_scene_numbers(config, scene.seed))
    return {"scene.json has other drawn numbers than its seed gives"};
  Random random(scene.seed);
  const int count = static_cast<int>(scene.scene.tubes.size());
  const std::vector<tube::Tube> expected = make_tubes(config, count, scene.seed, random);
  for (std::size_t k = 0; k < expected.size(); ++k)
    if (!has_numbers_of(scene.scene.tubes[k].tube, expected[k]))
      problems.push_back(fmt::format("tube {} has other drawn numbers than the scene's seed gives", k + 1));
  return problems;
}

}  // namespace tubebin::dataset
