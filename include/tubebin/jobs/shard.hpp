/// Which shard of a job this process does, and how work is distributed to shards. No shard talks to another: each
/// computes the same distribution from the same list.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tubebin::jobs {

/// Shard `index` (from 1) of `count`, which together are the whole.
struct Shard {
  int index = 1;
  int count = 1;

  bool is_whole() const { return count == 1; }
  /// "00002-of-00004", as its files are called.
  std::string name() const;
  friend bool operator==(const Shard&, const Shard&) = default;
};

/// "2/4" -> shard 2 of 4. Throws ConfigError.
Shard parse_shard(const std::string& text);

/// A shard, and who said so.
struct ShardChoice {
  Shard shard;
  std::string source;  ///< "--shard", or the scheduler's variables with their values; empty where nobody said anything

  /// Whether this process does one shard only, or was asked to by a scheduler.
  bool is_sharded() const { return !source.empty(); }
};

/// Value of an environment variable, or null.
using Environment = std::function<const char*(const char*)>;

/// The shard that `option` ("2/4") asks for; where it is empty, the one that a scheduler gave this process:
/// - Slurm: SLURM_ARRAY_TASK_ID with its MIN, STEP and COUNT (an array may start anywhere);
/// - Kubernetes (Indexed Job): JOB_COMPLETION_INDEX, from 0, and `count`;
/// - AWS Batch: AWS_BATCH_JOB_ARRAY_INDEX, from 0, and `count` or AWS_BATCH_JOB_ARRAY_SIZE.
/// `count` is checked where the scheduler says the number of shards itself. Throws ConfigError where the variables
/// contradict each other or leave the number of shards open.
ShardChoice choose_shard(const std::string& option, std::optional<int> count, const Environment& environment);

/// Indices, ascending, of those of the items with these costs that the shard does. Each item goes, the dearest first,
/// to the shard with the least to do (Graham 1969, longest processing time first: no shard does more than
/// 4/3 of what the best distribution could reach).
std::vector<std::size_t> items_of_shard(const std::vector<std::int64_t>& costs, Shard shard);

/// What scenes of so many tubes cost beside each other: microseconds of one core, as measured (docs/scale_out.md).
std::int64_t generation_cost(int tubes);
std::int64_t modeling_cost(int tubes);

}  // namespace tubebin::jobs
