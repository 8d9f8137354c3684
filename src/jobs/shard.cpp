#include "tubebin/jobs/shard.hpp"

#include <algorithm>
#include <charconv>
#include <numeric>
#include <queue>

#include "tubebin/core/error.hpp"

namespace tubebin::jobs {
namespace {

/// An integer in [min, 2^31) that a variable holds. Throws ConfigError.
int parse_variable(const std::string& name, const std::string& text, int min) {
  int value = 0;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  if (parsed.ec != std::errc() || parsed.ptr != end || value < min)
    throw_config_error("{}: '{}' is not valid; valid: a whole number from {}", name, text, min);
  return value;
}

/// The variables of one scheduler, read one by one and remembered for the message.
class Variables {
 public:
  explicit Variables(const Environment& environment) : environment_(environment) {}

  std::optional<int> read(const std::string& name, int min) {
    const char* text = environment_(name.c_str());
    if (text == nullptr || *text == '\0') return std::nullopt;
    source_ += fmt::format("{}{}={}", source_.empty() ? "" : ", ", name, text);
    return parse_variable(name, text, min);
  }
  void add(const std::string& text) { source_ += ", " + text; }
  const std::string& source() const { return source_; }

 private:
  const Environment& environment_;
  std::string source_;
};

void require_same_count(const std::optional<int>& given, int count, const Variables& variables) {
  if (given && *given != count)
    throw_config_error("--shard-count {}: the scheduler says {} ({}); leave one of them out, or say --shard I/N",
                       *given, count, variables.source());
}

/// Throws where a number of the array is left out, since then nobody can tell which shard is whose.
std::optional<ShardChoice> slurm_shard(const Environment& environment, std::optional<int> given_count) {
  Variables variables(environment);
  const std::optional<int> id = variables.read("SLURM_ARRAY_TASK_ID", 0);
  if (!id) return std::nullopt;
  const int min = variables.read("SLURM_ARRAY_TASK_MIN", 0).value_or(0);
  const int step = variables.read("SLURM_ARRAY_TASK_STEP", 1).value_or(1);
  const std::optional<int> max = variables.read("SLURM_ARRAY_TASK_MAX", 0);
  std::optional<int> count = variables.read("SLURM_ARRAY_TASK_COUNT", 1);
  if (!count && max) count = (*max - min) / step + 1;
  if (!count) count = given_count;
  if (!count) throw_config_error("SLURM_ARRAY_TASK_COUNT is missing beside {}; say --shard I/N", variables.source());
  const int offset = *id - min;
  if (offset < 0 || offset % step != 0 || offset / step >= *count || (max && (*max - min) / step + 1 != *count))
    throw_config_error(
        "the array's numbers are not evenly spaced ({}), so they don't say which shard is whose; say --shard I/N",
        variables.source());
  require_same_count(given_count, *count, variables);
  return ShardChoice{{offset / step + 1, *count}, variables.source()};
}

/// Schedulers that count from 0.
std::optional<ShardChoice> indexed_shard(const Environment& environment, std::optional<int> given_count,
                                         const std::string& index_name, const std::string& count_name) {
  Variables variables(environment);
  const std::optional<int> index = variables.read(index_name, 0);
  if (!index) return std::nullopt;
  std::optional<int> count = count_name.empty() ? std::nullopt : variables.read(count_name, 1);
  if (count) {
    require_same_count(given_count, *count, variables);
  } else {
    count = given_count;
    if (!count)
      throw_config_error(
          "{} says which shard this is, but not of how many; say --shard-count N or TUBEBIN_SHARD_COUNT=N",
          variables.source());
    variables.add(fmt::format("shard count {}", *count));
  }
  if (*index >= *count)
    throw_config_error("{}: there are shards 0 to {} only ({})", index_name, *count - 1, variables.source());
  return ShardChoice{{*index + 1, *count}, variables.source()};
}

}  // namespace

std::string Shard::name() const { return fmt::format("{:05}-of-{:05}", index, count); }

Shard parse_shard(const std::string& text) {
  Shard shard;
  const char* end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  const bool has_slash = index.ec == std::errc() && index.ptr != end && *index.ptr == '/';
  const auto count = std::from_chars(has_slash ? index.ptr + 1 : end, end, shard.count);
  if (!has_slash || count.ec != std::errc() || count.ptr != end || shard.index < 1 || shard.count < shard.index)
    throw_config_error("shard: '{}' is not valid; valid: I/N with I from 1 to N, as 1/4 for the first of four shards",
                       text);
  return shard;
}

ShardChoice choose_shard(const std::string& option, std::optional<int> count, const Environment& environment) {
  if (!option.empty()) return {parse_shard(option), "--shard"};
  if (auto slurm = slurm_shard(environment, count)) return *slurm;
  if (auto kubernetes = indexed_shard(environment, count, "JOB_COMPLETION_INDEX", "")) return *kubernetes;
  if (auto batch = indexed_shard(environment, count, "AWS_BATCH_JOB_ARRAY_INDEX", "AWS_BATCH_JOB_ARRAY_SIZE"))
    return *batch;
  return {};
}

std::vector<std::size_t> items_of_shard(const std::vector<std::int64_t>& costs, Shard shard) {
  std::vector<std::size_t> order(costs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return costs[a] > costs[b]; });

  using Load = std::pair<std::int64_t, int>;  // of the shard with this index, the least first
  std::priority_queue<Load, std::vector<Load>, std::greater<>> loads;
  for (int index = 1; index <= shard.count; ++index) loads.emplace(0, index);
  std::vector<std::size_t> own;
  for (const std::size_t i : order) {
    const auto [load, index] = loads.top();
    loads.pop();
    loads.emplace(load + costs[i], index);
    if (index == shard.index) own.push_back(i);
  }
  std::sort(own.begin(), own.end());
  return own;
}

std::int64_t generation_cost(int tubes) { return 11'000 + 2'000 * tubes + 430 * std::int64_t{tubes} * tubes; }

std::int64_t modeling_cost(int tubes) { return 12'000 + 3'700 * tubes + 120 * std::int64_t{tubes} * tubes; }

}  // namespace tubebin::jobs
