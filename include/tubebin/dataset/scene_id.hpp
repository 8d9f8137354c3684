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
  int tubes = 0;        ///< number of tubes that were dropped into the bin
  int case_number = 0;  ///< from 1
  int step = -1;        ///< tubes that were lifted out; -1: the bin is not emptied

  /// "A10/007": the scene's folder in its data set. From case 1000 on, each thousand has a folder of its own,
  /// "A1/12000/12345", so that no folder has more than 2000 entries.
  /// A step of emptying a bin is "A10/007/step_03".
  std::string name() const;
  int tubes_in_bin() const { return step > 0 ? tubes - step : tubes; }
  /// The pile whose step this is: the same id where it is none.
  SceneId pile() const { return {.set = set, .tubes = tubes, .case_number = case_number}; }
  auto operator<=>(const SceneId&) const = default;
};

/// The scenes that the configuration asks for, in order: all, or those of a shard, distributed by their cost.
std::vector<SceneId> list_scenes(const DatasetConfig& config, jobs::Shard shard = {});

}  // namespace tubebin::dataset
