#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/evaluation/cloud_pair.hpp"
#include "tubebin/evaluation/scene_picture.hpp"
#include "tubebin/scene/dataset_files.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin {

std::optional<LabelledPoints> read_points(const RunScore& run) {
  if (run.dataset.empty() || run.filtered.empty() || run.labeled.empty()) return std::nullopt;
  const DatasetFiles dataset(run.dataset);
  const std::string cloud = dataset.cloud_of(run.key.scene);
  Cloud filtered = !cloud.empty() && run.filtered == dataset.place(run.key.scene, cloud)
                       ? parse_cloud(dataset.read(run.key.scene, cloud), run.filtered)
                       : read_cloud(run.filtered);
  if (filtered.labels.empty()) return std::nullopt;
  filtered.colors.clear();
  const Cloud labeled = read_cloud(run.labeled);
  const PairedIds pairs = pair_clouds({filtered, run.filtered}, {labeled, run.labeled});
  LabelledPoints result;
  result.scanner =
      parse_scene_json(dataset.read(run.key.scene, "scene.json"), dataset.place(run.key.scene, "scene.json"))
          .scene.scanner;
  result.ratio = run.key.ratio;
  for (std::size_t i = 0; i < pairs.points.size(); ++i) {
    if (pairs.truth[i] == 0 && pairs.predicted[i] == kNullId) continue;
    result.points.push_back(filtered.points[pairs.points[i]]);
    result.truth.push_back(pairs.truth[i]);
    result.predicted.push_back(pairs.predicted[i]);
  }
  return result;
}

}  // namespace tubebin
