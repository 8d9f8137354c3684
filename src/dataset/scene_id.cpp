#include "tubebin/dataset/scene_id.hpp"

#include <charconv>

namespace tubebin {

std::string SceneId::name() const { return fmt::format("{}{}/{:03}", set, tubes, case_number); }

Shard parse_shard(const std::string& text) {
  Shard shard;
  const char* end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  const bool has_slash = index.ec == std::errc() && index.ptr != end && *index.ptr == '/';
  const auto count = std::from_chars(has_slash ? index.ptr + 1 : end, end, shard.count);
  if (!has_slash || count.ec != std::errc() || count.ptr != end || shard.index < 1 || shard.count < shard.index)
    throw_config_error("shard: '{}' is not valid; valid: I/N with I from 1 to N, as 1/4 for the first of four parts",
                       text);
  return shard;
}

std::vector<SceneId> list_scenes(const DatasetConfig& config, Shard shard) {
  std::vector<SceneId> scenes;
  int position = 0;
  for (const int tubes : config.tubes)
    for (int case_number = 1; case_number <= config.cases; ++case_number)
      if (position++ % shard.count == shard.index - 1) scenes.push_back({config.set, tubes, case_number});
  return scenes;
}

}  // namespace tubebin
