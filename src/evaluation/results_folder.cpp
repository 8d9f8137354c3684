#include "tubebin/evaluation/results_folder.hpp"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <set>

#include "parallel.hpp"
#include "scene/json_reader.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin {
namespace {

namespace fs = std::filesystem;

constexpr const char* kIndexFormat = "tubebin results 1";
constexpr const char* kResultFormat = "tubebin result 1";
constexpr int kMaxPoints = std::numeric_limits<int>::max();
constexpr std::uint64_t kMaxLabel = std::numeric_limits<std::uint32_t>::max();

/// index.json: what the folder is to hold.
struct Index {
  std::string dataset;
  std::vector<std::string> methods;
  std::vector<double> ratios;
  std::vector<std::string> scenes;
  std::string configuration;
};

void check_format(const JsonPlace& root, const char* expected) {
  if (root.at("format").text() != expected) root.at("format").fail(fmt::format("\"{}\"", expected));
}

Index read_index(const std::string& folder) {
  if (!fs::is_directory(folder)) throw_io_error("{}: is no folder", folder);
  const std::string path = folder + "/index.json";
  if (!fs::exists(path))
    throw_io_error(
        "{}: has no index.json, so it is no results folder of model_tubes{}", folder,
        fs::exists(folder + "/manifest.jsonl") ? "; it is a data set, which --predictions can be scored on" : "");
  const nlohmann::json json = parse_json(read_file(path), path);
  const JsonPlace root(json, path);
  check_format(root, kIndexFormat);
  Index index;
  index.dataset = (fs::path(folder) / root.at("dataset").text()).lexically_normal().string();
  for (const JsonPlace& method : root.at("methods").elements()) index.methods.push_back(method.text());
  for (const JsonPlace& ratio : root.at("ratios").elements()) index.ratios.push_back(ratio.number());
  for (const JsonPlace& scene : root.at("scenes").elements()) index.scenes.push_back(scene.text());
  for (const char* key : {"tool_version", "dataset", "seed", "options"}) root.at(key);
  index.configuration = nlohmann::ordered_json{
      {"tool_version", json["tool_version"]},
      {"dataset", json["dataset"]},
      {"seed", json["seed"]},
      {"options",
       json["options"]}}.dump(2);
  return index;
}

Contingency read_contingency(const JsonPlace& root, const std::string& path) {
  if (!root.has("contingency"))
    throw_io_error("{}: /contingency: missing; the cloud has neither labels nor known colours, so it cannot be scored",
                   path);
  std::vector<std::tuple<SegmentId, SegmentId, std::int64_t>> entries;
  std::set<SegmentId> truth_ids;
  std::set<SegmentId> predicted_ids;
  for (const JsonPlace& entry : root.at("contingency").elements()) {
    const std::vector<JsonPlace> parts = entry.elements(3);
    const auto truth = static_cast<SegmentId>(parts[0].whole(0, kMaxLabel));
    const auto predicted = static_cast<SegmentId>(parts[1].whole(0, kMaxLabel));
    entries.emplace_back(truth, predicted, static_cast<std::int64_t>(parts[2].whole(0, kMaxPoints)));
    truth_ids.insert(truth);
    if (predicted != kNullId) predicted_ids.insert(predicted);
  }
  Contingency contingency;
  contingency.bin_id = 0;
  contingency.truth_ids.assign(truth_ids.begin(), truth_ids.end());
  contingency.predicted_ids.assign(predicted_ids.begin(), predicted_ids.end());
  contingency.unlabeled.assign(truth_ids.size(), 0);
  contingency.counts =
      Counts::Zero(static_cast<Eigen::Index>(truth_ids.size()), static_cast<Eigen::Index>(predicted_ids.size()));
  for (const auto& [truth, predicted, points] : entries) {
    const auto row = std::distance(truth_ids.begin(), truth_ids.find(truth));
    if (predicted == kNullId) contingency.unlabeled[static_cast<std::size_t>(row)] += points;
    else contingency.counts(row, std::distance(predicted_ids.begin(), predicted_ids.find(predicted))) += points;
  }
  const auto filtered_points = static_cast<std::int64_t>(root.at("filtered_points").whole(0, kMaxPoints));
  if (contingency.total() != filtered_points)
    root.at("filtered_points").fail(fmt::format("{}, which the contingency's points sum to", contingency.total()));
  return contingency;
}

std::vector<Centerline> read_model(const std::string& path) {
  const nlohmann::json json = parse_json(read_file(path), path);
  std::vector<Centerline> model;
  for (const JsonPlace& tube : JsonPlace(json, path).at("tubes").elements()) {
    Centerline line;
    for (const JsonPlace& cylinder : tube.at("cylinders").elements())
      line.push_back({cylinder.at("start").vector(), cylinder.at("end").vector(),
                      cylinder.has("bridged") && cylinder.at("bridged").flag()});
    model.push_back(std::move(line));
  }
  return model;
}

/// A number with as few digits as tell it exactly, as in the runs' folder names.
std::string run_folder(const std::string& scene, const std::string& method, double ratio) {
  return fmt::format("{}/{}_{}", scene, method, ratio);
}

RunScore read_run(const std::string& folder, RunKey key, const SceneTruth* truth) {
  const std::string path = folder + "/result.json";
  const nlohmann::json json = parse_json(read_file(path), path);
  const JsonPlace root(json, path);
  check_format(root, kResultFormat);
  key.set = root.at("set").text();
  key.tubes = root.at("tubes").integer({0, 1000000});
  key.case_number = root.at("case").integer({0, 1000000000});
  if (root.at("scene").text() != key.scene) root.at("scene").fail(fmt::format("\"{}\", the folder's scene", key.scene));
  const std::string model_path = folder + "/model.json";
  const bool has_model = truth != nullptr && fs::exists(model_path);
  const Contingency contingency = read_contingency(root, path);
  const std::vector<Centerline> model = has_model ? read_model(model_path) : std::vector<Centerline>{};
  RunScore run = score_run(key, contingency, match_segments(contingency), truth, model);
  // Segments without a point in the filtered cloud are tubes of the model all the same.
  run.scores.predicted_tubes = std::max(run.scores.predicted_tubes, root.at("model_tubes").integer({0, kMaxPoints}));
  run.folder = folder;
  if (fs::exists(folder + "/filtered.pcd") && fs::exists(folder + "/labeled.pcd")) {
    run.filtered = folder + "/filtered.pcd";
    run.labeled = folder + "/labeled.pcd";
  }
  if (const std::string times = folder + "/times.json"; fs::exists(times)) {
    const nlohmann::json times_json = parse_json(read_file(times), times);
    run.seconds = JsonPlace(times_json, times).at("total").number();
  }
  return run;
}

/// Reasons by run folder, as failures.jsonl gives them.
std::map<std::string, std::string> read_failures(const std::string& folder) {
  std::map<std::string, std::string> reasons;
  const std::string path = folder + "/failures.jsonl";
  if (!fs::exists(path)) return reasons;
  const std::string text = read_file(path);
  for (std::size_t start = 0, line = 1; start < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    if (end > start) {
      const std::string name = fmt::format("{}:{}", path, line);
      const nlohmann::json json = parse_json(text.substr(start, end - start), name);
      const JsonPlace root(json, name);
      reasons[run_folder(root.at("scene").text(), root.at("method").text(), root.at("ratio").number())] =
          root.at("error").text();
    }
    start = end + 1;
  }
  return reasons;
}

/// A run without a result, with every tube of the scene missed.
RunScore failed_run(RunKey key, const SceneRecord* scene, const SceneTruth* truth) {
  Contingency contingency;
  if (scene != nullptr) {
    for (std::size_t k = 0; k < scene->tube_pixels.size(); ++k) {
      contingency.truth_ids.push_back(static_cast<SegmentId>(k + 1));
      contingency.unlabeled.push_back(static_cast<std::int64_t>(scene->tube_pixels[k]));
    }
    key.tubes = static_cast<int>(scene->scene.tubes.size());
  }
  contingency.counts.resize(static_cast<Eigen::Index>(contingency.truth_ids.size()), 0);
  RunScore run = score_run(key, contingency, match_segments(contingency), truth, {});
  run.failed = true;
  return run;
}

/// What one scene adds to the evaluation.
struct SceneRuns {
  std::vector<RunScore> runs;
  std::vector<std::string> missing;
  std::vector<std::string> failed;
  bool has_truth = false;
};

SceneRuns read_scene_runs(const std::string& folder, const Index& index, const std::string& scene,
                          const std::map<std::string, std::string>& failures) {
  std::optional<SceneRecord> record;
  std::optional<SceneTruth> truth;
  if (const std::string path = index.dataset + "/" + scene + "/scene.json"; fs::exists(path)) {
    record = read_scene_json(path);
    truth.emplace(record->scene);
  }
  const SceneTruth* known_truth = truth ? &*truth : nullptr;

  SceneRuns result;
  result.has_truth = truth.has_value();
  for (const std::string& method : index.methods) {
    for (const double ratio : index.ratios) {
      RunKey key = parse_scene_name(scene);
      key.method = method;
      key.ratio = ratio;
      const std::string run = run_folder(scene, method, ratio);
      if (fs::exists(folder + "/" + run)) {
        result.runs.push_back(read_run(folder + "/" + run, key, known_truth));
        if (truth) result.runs.back().dataset = index.dataset;
      } else if (const auto failure = failures.find(run); failure != failures.end()) {
        result.runs.push_back(failed_run(key, record ? &*record : nullptr, known_truth));
        result.failed.push_back(fmt::format("{}: {}", key.name(), failure->second));
      } else {
        result.missing.push_back(key.name());
      }
    }
  }
  return result;
}

void append(Evaluation& evaluation, SceneRuns& scene) {
  const auto move_all = [](auto& from, auto& to) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
  };
  move_all(scene.runs, evaluation.runs);
  move_all(scene.missing, evaluation.missing);
  move_all(scene.failed, evaluation.failed);
}

/// One folder's runs, added to the evaluation.
void read_folder(const std::string& folder, const ResultsOptions& options, Evaluation& evaluation) {
  Index index = read_index(folder);
  if (!options.dataset.empty()) index.dataset = options.dataset;
  const std::map<std::string, std::string> failures = read_failures(folder);
  std::vector<SceneRuns> scenes(index.scenes.size());
  parallel_for(
      scenes.size(), options.jobs,
      [&](std::size_t i) { scenes[i] = read_scene_runs(folder, index, index.scenes[i], failures); },
      options.on_progress);

  const std::size_t runs_before = evaluation.runs.size();
  std::size_t without_truth = 0;
  for (SceneRuns& scene : scenes) {
    without_truth += scene.has_truth ? 0 : 1;
    append(evaluation, scene);
  }
  if (evaluation.runs.size() == runs_before)
    throw_io_error("{}: has none of the runs that its index.json names", folder);
  if (without_truth > 0)
    evaluation.notes.push_back(
        fmt::format("{} of {} scenes have no scene.json in {}: they add nothing to centreline errors and "
                    "visibility (--dataset "
                    "DIR says where the data set is)",
                    without_truth, scenes.size(), index.dataset));
  evaluation.source += (evaluation.source.empty() ? "" : ", ") + folder;
  evaluation.configuration += fmt::format("{}:\n{}\n", folder, index.configuration);
  if (const std::string config = index.dataset + "/config.yaml"; fs::exists(config))
    evaluation.configuration += fmt::format("\n{}:\n{}\n", config, read_file(config));
}

void require_distinct_runs(const Evaluation& evaluation) {
  std::set<std::string> names;
  for (const RunScore& run : evaluation.runs)
    if (!names.insert(run.key.name()).second)
      throw_io_error("{}: the run {} is there twice", evaluation.source, run.key.name());
}

}  // namespace

Evaluation read_results(const std::vector<std::string>& folders, const ResultsOptions& options) {
  Evaluation evaluation;
  for (const std::string& folder : folders) read_folder(folder, options, evaluation);
  require_distinct_runs(evaluation);
  return evaluation;
}

}  // namespace tubebin
