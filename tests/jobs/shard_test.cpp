// Shards of a job: who says which shard this is, and which items it has.
#include "tubebin/jobs/shard.hpp"

#include <gmock/gmock.h>

#include <map>
#include <numeric>

#include "tubebin/core/error.hpp"
#include "tubebin/dataset/scene_id.hpp"

namespace tubebin::jobs {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

using Variables = std::map<std::string, std::string>;

ShardChoice choose(const Variables& variables, const std::string& option = "", std::optional<int> count = {}) {
  return choose_shard(option, count, [&](const char* name) {
    const auto found = variables.find(name);
    return found == variables.end() ? nullptr : found->second.c_str();
  });
}

Variables slurm(int id, int min, int max, int step, int count) {
  return {{"SLURM_ARRAY_TASK_ID", std::to_string(id)},
          {"SLURM_ARRAY_TASK_MIN", std::to_string(min)},
          {"SLURM_ARRAY_TASK_MAX", std::to_string(max)},
          {"SLURM_ARRAY_TASK_STEP", std::to_string(step)},
          {"SLURM_ARRAY_TASK_COUNT", std::to_string(count)}};
}

TEST(ChooseShard, WithoutAnyWordItIsTheWhole) {
  const ShardChoice choice = choose({});
  EXPECT_EQ(choice.shard, (Shard{1, 1}));
  EXPECT_FALSE(choice.is_sharded());
}

TEST(ChooseShard, TheOptionComesFirst) {
  const ShardChoice choice = choose(slurm(3, 1, 4, 1, 4), "2/9");
  EXPECT_EQ(choice.shard, (Shard{2, 9}));
  EXPECT_EQ(choice.source, "--shard");
}

TEST(ChooseShard, SlurmArraysMayStartAnywhere) {
  for (const int first : {0, 1, 17})
    for (const int step : {1, 5})
      for (int task = 0; task < 4; ++task) {
        const ShardChoice choice = choose(slurm(first + step * task, first, first + 3 * step, step, 4));
        EXPECT_EQ(choice.shard, (Shard{task + 1, 4})) << first << " " << step;
        EXPECT_THAT(choice.source, HasSubstr("SLURM_ARRAY_TASK_ID=" + std::to_string(first + step * task)));
      }
  // --array=0-10:5 has the numbers 0, 5 and 10; its last number may also lie below the given one: 0-12:5.
  EXPECT_EQ(choose(slurm(10, 0, 12, 5, 3)).shard, (Shard{3, 3}));
}

TEST(ChooseShard, SlurmArraysWithHolesAreRefused) {
  EXPECT_THAT([] { choose(slurm(7, 1, 7, 2, 3)); },  // --array=1,3,7
              ThrowsMessage<ConfigError>(AllOf(HasSubstr("not evenly spaced"), HasSubstr("say --shard I/N"))));
  EXPECT_THROW(choose(slurm(4, 1, 7, 2, 4)), ConfigError);
  EXPECT_THROW(choose({{"SLURM_ARRAY_TASK_ID", "3"}}), ConfigError);
  EXPECT_THROW(choose({{"SLURM_ARRAY_TASK_ID", "three"}}), ConfigError);
  EXPECT_THAT([] { choose(slurm(1, 1, 4, 1, 4), "", 5); },
              ThrowsMessage<ConfigError>(AllOf(HasSubstr("--shard-count 5"), HasSubstr("scheduler says 4"))));
}

TEST(ChooseShard, KubernetesCountsFromZeroAndNeedsTheCount) {
  const ShardChoice choice = choose({{"JOB_COMPLETION_INDEX", "3"}}, "", 8);
  EXPECT_EQ(choice.shard, (Shard{4, 8}));
  EXPECT_EQ(choice.source, "JOB_COMPLETION_INDEX=3, shard count 8");
  EXPECT_THAT(
      [] {
        choose({{"JOB_COMPLETION_INDEX", "3"}});
      },
      ThrowsMessage<ConfigError>(HasSubstr("TUBEBIN_SHARD_COUNT")));
  EXPECT_THROW(choose({{"JOB_COMPLETION_INDEX", "8"}}, "", 8), ConfigError);
}

TEST(ChooseShard, AwsBatchCountsFromZero) {
  EXPECT_EQ(choose({{"AWS_BATCH_JOB_ARRAY_INDEX", "0"}}, "", 2).shard, (Shard{1, 2}));
  EXPECT_EQ(choose({{"AWS_BATCH_JOB_ARRAY_INDEX", "4"}, {"AWS_BATCH_JOB_ARRAY_SIZE", "5"}}).shard, (Shard{5, 5}));
  EXPECT_THROW(choose({{"AWS_BATCH_JOB_ARRAY_INDEX", "4"}}), ConfigError);
}

/// What each shard is given to do.
std::vector<std::int64_t> loads(const std::vector<std::int64_t>& costs, int shards) {
  std::vector<std::int64_t> loads;
  std::vector<int> owners(costs.size(), 0);
  for (int shard = 1; shard <= shards; ++shard) {
    loads.push_back(0);
    for (const std::size_t i : items_of_shard(costs, {shard, shards})) {
      loads.back() += costs[i];
      ++owners[i];
    }
  }
  EXPECT_THAT(owners, ::testing::Each(1));  // every item belongs to a shard, and to one
  return loads;
}

TEST(Deal, GivesPartsAboutEqualWork) {
  dataset::DatasetConfig config;  // set A: 1 to 15 and 20 tubes, 20 cases each
  std::vector<std::int64_t> costs;
  for (const dataset::SceneId& id : dataset::list_scenes(config)) costs.push_back(generation_cost(id.tubes));
  for (const int shards : {2, 3, 7, 16, 50}) {
    const std::vector<std::int64_t> loads_of_shards = loads(costs, shards);
    const auto [least, most] = std::minmax_element(loads_of_shards.begin(), loads_of_shards.end());
    EXPECT_LT(static_cast<double>(*most), 1.10 * static_cast<double>(*least)) << shards;
  }
}

TEST(Deal, StaysWithinGrahamsBound) {
  // The best distribution of 7 7 6 6 5 5 4 4 4 to four shards is 12 each; this rule reaches 15 <= 12 (4/3 - 1/12).
  const std::vector<std::int64_t> loads_of_shards = loads({7, 7, 6, 6, 5, 5, 4, 4, 4}, 4);
  EXPECT_EQ(*std::max_element(loads_of_shards.begin(), loads_of_shards.end()), 15);
}

TEST(Deal, LeavesPartsEmptyWhereThereIsTooLittle) {
  EXPECT_THAT(loads({5, 5}, 4), ::testing::UnorderedElementsAre(5, 5, 0, 0));
}

TEST(Deal, MoreTubesCostMore) {
  for (int tubes = 1; tubes < 200; ++tubes) {
    EXPECT_LT(generation_cost(tubes), generation_cost(tubes + 1));
    EXPECT_LT(modeling_cost(tubes), modeling_cost(tubes + 1));
  }
}

}  // namespace
}  // namespace tubebin::jobs
