#include <filesystem>

#include "core/json_reader.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/version.hpp"
#include "tubebin/dataset/dataset_config.hpp"
#include "tubebin/results/model_dataset.hpp"

namespace tubebin::results {
namespace {

namespace fs = std::filesystem;

modeling::ModelingMethod parse_method(const JsonPlace& place) {
  const std::string name = place.text();
  if (name == "centerline") return modeling::ModelingMethod::centerline;
  if (name != "region_growing") place.fail("\"centerline\" or \"region_growing\"");
  return modeling::ModelingMethod::region_growing;
}

}  // namespace

ResumedBatch resume_batch(const std::vector<std::string>& results) {
  const std::string path = results.front() + "/index.json";
  const nlohmann::json json = parse_json(read_file(path), path);
  const JsonPlace root(json, path);
  if (const std::string version = root.at("tool_version").text(); version != tool_version())
    throw_config_error("{}: version {} made these results, and {} is running, whose results may differ", path, version,
                       tool_version());
  ResumedBatch batch;
  BatchOptions& options = batch.options;
  options.dataset = (fs::path(results.front()) / root.at("dataset").text()).lexically_normal().string();
  options.results = results.front();
  options.other_results.assign(results.begin() + 1, results.end());
  options.methods.clear();
  options.ratios.clear();
  for (const JsonPlace& method : root.at("methods").elements()) options.methods.push_back(parse_method(method));
  for (const JsonPlace& ratio : root.at("ratios").elements()) options.ratios.push_back(ratio.number());
  for (const JsonPlace& scene : root.at("scenes").elements())
    options.scenes.push_back(ConfinedPath::parse(scene.text(), path + ": /scenes"));
  root.at("options").fields([&](Fields& fields) { describe(fields, batch.config); });
  return batch;
}

}  // namespace tubebin::results
