#include "tubebin/dataset/scene_id.hpp"

namespace tubebin::dataset {

std::string SceneId::name() const {
  if (case_number < 1000) return fmt::format("{}{}/{:03}", set, tubes, case_number);
  return fmt::format("{}{}/{}/{}", set, tubes, case_number / 1000 * 1000, case_number);
}

std::vector<SceneId> list_scenes(const DatasetConfig& config, jobs::Shard shard) {
  std::vector<SceneId> all;
  for (const int tubes : config.tubes)
    for (int case_number = 1; case_number <= config.cases; ++case_number)
      all.push_back({config.set, tubes, case_number});
  if (shard.is_whole()) return all;

  std::vector<std::int64_t> costs;
  costs.reserve(all.size());
  for (const SceneId& id : all) costs.push_back(jobs::generation_cost(id.tubes));
  std::vector<SceneId> own;
  for (const std::size_t i : items_of_shard(costs, shard)) own.push_back(std::move(all[i]));
  return own;
}

}  // namespace tubebin::dataset
