#include "tubebin/dataset/timing_table.hpp"

#include <map>

namespace tubebin::dataset {
namespace {

struct Mean {
  double sum = 0.0;
  int count = 0;
};

std::map<int, Mean> mean_seconds(const Manifest& manifest, const std::vector<SceneId>& scenes) {
  std::map<int, Mean> means;
  for (const SceneId& scene : scenes) {
    const ManifestRecord* record = manifest.find(scene.name());
    if (record == nullptr || !record->seconds.contains("total")) continue;
    Mean& mean = means[scene.tubes];
    mean.sum += record->seconds.at("total");
    ++mean.count;
  }
  return means;
}

}  // namespace

std::string format_timing_table(const Manifest& manifest, const std::vector<SceneId>& scenes,
                                const SecondsByTubes& paper_seconds) {
  const std::map<int, Mean> means = mean_seconds(manifest, scenes);
  if (means.empty()) return "";
  const std::string& set = scenes.front().set;
  std::string text = fmt::format(
      "Average time to generate a test case of set {} (seconds of one worker process, rejected attempts "
      "included),\n"
      "beside Table 1 of the paper\n{:>6} {:>7} {:>9} {:>9} {:>9}\n",
      set, "tubes", "cases", "here", "paper", "speed-up");
  for (const auto& [tubes, mean] : means) {
    const double here = mean.sum / mean.count;
    text += fmt::format("{:>6} {:>7} {:>9.3f}", tubes, mean.count, here);
    if (const auto paper = paper_seconds.find(tubes); paper != paper_seconds.end())
      text += fmt::format(" {:>9.2f} {:>8.0f}x\n", paper->second, paper->second / here);
    else text += fmt::format(" {:>9} {:>9}\n", "-", "-");
  }
  return text;
}

}  // namespace tubebin::dataset
