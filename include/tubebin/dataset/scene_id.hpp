/// The name of one scene of a data set.
#pragma once

#include <compare>
#include <string>
#include <vector>

#include "tubebin/dataset/dataset_config.hpp"

namespace tubebin {

struct SceneId {
  std::string set;      ///< "A"
  int tubes = 0;        ///< number of tubes in the bin
  int case_number = 0;  ///< from 1

  /// "A10/007": the scene's folder in its data set.
  std::string name() const;
  auto operator<=>(const SceneId&) const = default;
};

/// Part `index` (from 1) of `count`, which together are the whole.
struct Shard {
  int index = 1;
  int count = 1;
};

/// "2/4" -> part 2 of 4. Throws ConfigError.
Shard parse_shard(const std::string& text);

/// The scenes that the configuration asks for, in order; a shard takes every count-th of them.
std::vector<SceneId> list_scenes(const DatasetConfig& config, Shard shard = {});

}  // namespace tubebin
