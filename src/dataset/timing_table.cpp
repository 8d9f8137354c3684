#include "tubebin/dataset/timing_table.hpp"

#include <algorithm>
#include <map>

namespace tubebin::dataset {
namespace {

struct Sums {
  double seconds = 0.0;  ///< without previews
  double preview = 0.0;
  int count = 0;
};

std::map<int, Sums> sums_by_tubes(const Manifest& manifest, const std::vector<SceneId>& scenes) {
  std::map<int, Sums> sums;
  for (const SceneId& scene : scenes) {
    const ManifestRecord* record = manifest.find(scene.name());
    if (record == nullptr || !record->seconds.contains("total")) continue;
    Sums& sum = sums[scene.tubes];
    sum.seconds += record->seconds.at("total");
    if (const auto preview = record->seconds.find("preview"); preview != record->seconds.end())
      sum.preview += preview->second;
    ++sum.count;
  }
  return sums;
}

}  // namespace

std::string format_timing_table(const Manifest& manifest, const std::vector<SceneId>& scenes,
                                const SecondsByTubes& paper_seconds) {
  const std::map<int, Sums> sums = sums_by_tubes(manifest, scenes);
  if (sums.empty()) return "";
  const bool has_previews =
      std::any_of(sums.begin(), sums.end(), [](const auto& sum) { return sum.second.preview > 0.0; });
  std::string text = fmt::format(
      "Average time to generate a test case of set {} (seconds of one worker process, rejected attempts "
      "included),\n"
      "beside Table 1 of the paper{}\n{:>6} {:>7} {:>9} {:>9} {:>9}{}\n",
      scenes.front().set, has_previews ? "; pictures, which it has none of, apart" : "", "tubes", "cases", "here",
      "paper", "speed-up", has_previews ? "  pictures" : "");
  for (const auto& [tubes, sum] : sums) {
    const double here = sum.seconds / sum.count;
    text += fmt::format("{:>6} {:>7} {:>9.3f}", tubes, sum.count, here);
    if (const auto paper = paper_seconds.find(tubes); paper != paper_seconds.end())
      text += fmt::format(" {:>9.2f} {:>8.0f}x", paper->second, paper->second / here);
    else text += fmt::format(" {:>9} {:>9}", "-", "-");
    text += has_previews ? fmt::format(" {:>9.3f}\n", sum.preview / sum.count) : "\n";
  }
  return text;
}

}  // namespace tubebin::dataset
