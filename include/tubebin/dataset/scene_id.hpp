/// The name of one scene of a data set.
#pragma once

#include <compare>
#include <string>
#include <vector>

#include "tubebin/dataset/dataset_config.hpp"
#include "tubebin/jobs/shard.hpp"

namespace tubebin::dataset {

struct SceneId {
  std::string set;      ///< "A"
  int tubes = 0;        ///< number of tubes in the bin
  int case_number = 0;  ///< from 1

  /// "A10/007": the scene's folder in its data set. From case 1000 on, each thousand has a folder of its own,
  /// "A1/12000/12345", so that no folder has more than 2000 entries.
  std::string name() const;
  auto operator<=>(const SceneId&) const = default;
};

/// The scenes that the configuration asks for, in order: all, or those of a shard, distributed by their cost.
std::vector<SceneId> list_scenes(const DatasetConfig& config, jobs::Shard shard = {});

}  // namespace tubebin::dataset
