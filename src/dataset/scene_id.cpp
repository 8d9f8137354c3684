#include "tubebin/dataset/scene_id.hpp"

#include <algorithm>

namespace tubebin::dataset {

namespace {

/// One, or one for each step.
void append_scenes(const DatasetConfig& config, const SceneId& pile, std::vector<SceneId>& scenes) {
  if (config.sequence.lifts == 0) return scenes.push_back(pile);
  for (int step = 0; step <= std::min(config.sequence.lifts, pile.tubes - 1); ++step) {
    scenes.push_back(pile);
    scenes.back().step = step;
  }
}

}  // namespace

std::string SceneId::name() const {
  if (step >= 0) return fmt::format("{}/step_{:02}", pile().name(), step);
  if (case_number < 1000) return fmt::format("{}{}/{:03}", set, tubes, case_number);
  return fmt::format("{}{}/{}/{}", set, tubes, case_number / 1000 * 1000, case_number);
}

std::vector<SceneId> list_scenes(const DatasetConfig& config, jobs::Shard shard) {
  std::vector<SceneId> piles;
  std::vector<std::int64_t> costs;
  for (const int tubes : config.tubes)
    for (int case_number = 1; case_number <= config.cases; ++case_number) {
      piles.push_back({.set = config.set, .tubes = tubes, .case_number = case_number});
      costs.push_back(jobs::generation_cost(tubes));
    }
  std::vector<SceneId> scenes;
  if (shard.is_whole())
    for (const SceneId& pile : piles) append_scenes(config, pile, scenes);
  else
    for (const std::size_t i : items_of_shard(costs, shard)) append_scenes(config, piles[i], scenes);
  return scenes;
}

}  // namespace tubebin::dataset
