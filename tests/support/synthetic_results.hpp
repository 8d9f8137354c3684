/// A made-up data set and a made-up results folder of it, with known micro-recall.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/program.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/file_record.hpp"
#include "tubebin/evaluation/run_score.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin::testing {

namespace fs = std::filesystem;

constexpr int kPointsPerTube = 1000;

struct SyntheticSweep {
  std::vector<std::string> sets = {"A", "B"};
  std::vector<int> tubes = {1, 2, 3};
  int cases = 2;
  std::vector<std::string> methods = {"centerline"};
  std::vector<double> ratios = {0.3, 1.0};
  int cylinders = 5;
};

inline std::string scene_name(const std::string& set, int tubes, int number) {
  return fmt::format("{}{}/{:03}", set, tubes, number);
}

/// Wrong points of every tube: more with more tubes and at low ratios, more in set B, and in single tubes of
/// B.
inline int wrong_points(const evaluation::RunKey& key) {
  const double slope = key.set == "A" ? 4.0 : 6.0;
  const double at_low_ratios = 30.0 * std::max(0.0, 0.6 - key.ratio);
  const double single = key.set == "B" && key.tubes == 1 ? 50.0 : 0.0;
  return static_cast<int>(5.0 + slope * key.tubes + at_low_ratios + single) + key.case_number % 2;
}

/// Straight tubes side by side on the bin's floor.
inline scene::SceneRecord synthetic_scene(const std::string& name, int tubes, int cylinders) {
  scene::SceneRecord record;
  record.id = name;
  record.seed = 1;
  record.window = {0, 0, record.scene.scanner.width, record.scene.scanner.height};
  record.colors = {0x808080};
  for (int k = 0; k < tubes; ++k) {
    scene::PlacedTube placed;
    placed.tube.radius = 0.005;
    placed.tube.mass = 0.055;
    const double y = 0.012 * (k - tubes / 2);
    for (int i = 0; i <= cylinders; ++i) placed.tube.nodes.emplace_back(-0.25 + 0.5 * i / cylinders, y, 0.005);
    for (int i = 0; i < cylinders; ++i) placed.tube.cylinders.push_back({i, i + 1, i});
    record.scene.tubes.push_back(placed);
    record.colors.push_back(0x100000U + static_cast<cloud::Color>(k));
    record.tube_pixels.push_back(kPointsPerTube);
  }
  return record;
}

inline nlohmann::json result_json(const evaluation::RunKey& key) {
  nlohmann::json contingency = nlohmann::json::array();
  nlohmann::json labels = {0};
  nlohmann::json points = {0};
  const int wrong = wrong_points(key);
  for (int k = 1; k <= key.tubes; ++k) {
    const int other = k % key.tubes + 1;
    if (other < k || key.tubes == 1) contingency.push_back({k, key.tubes == 1 ? 0 : other, wrong});
    contingency.push_back({k, k, kPointsPerTube - wrong});
    if (other > k && key.tubes > 1) contingency.push_back({k, other, wrong});
    labels.push_back(k);
    points.push_back(kPointsPerTube);
  }
  return {{"format", "tubebin result 1"},
          {"scene", key.scene},
          {"set", key.set},
          {"tubes", key.tubes},
          {"case", key.case_number},
          {"method", key.method},
          {"ratio", key.ratio},
          {"seed", 1},
          {"cloud_points", 5 * kPointsPerTube * key.tubes},
          {"filtered_points", kPointsPerTube * key.tubes},
          {"labeled_points", kPointsPerTube * key.tubes},
          {"model_tubes", key.tubes},
          {"truth_labels", labels},
          {"truth_points", points},
          {"contingency", contingency}};
}

/// The real tubes, 0.4 mm too high.
inline nlohmann::json model_json(const scene::SceneRecord& scene) {
  nlohmann::json tubes = nlohmann::json::array();
  for (const scene::PlacedTube& tube : scene.scene.tubes) {
    nlohmann::json cylinders = nlohmann::json::array();
    for (const evaluation::CenterlineSegment& segment : evaluation::centerline(tube))
      cylinders.push_back({{"start", {segment.start.x(), segment.start.y(), segment.start.z() + 0.0004}},
                           {"end", {segment.end.x(), segment.end.y(), segment.end.z() + 0.0004}},
                           {"radius", tube.tube.radius}});
    tubes.push_back({{"cylinders", cylinders}});
  }
  return {{"tubes", tubes}};
}

inline double modelling_seconds(const evaluation::RunKey& key) { return 0.01 + 0.02 * key.tubes * key.ratio; }

inline std::string run_folder(const evaluation::RunKey& key) {
  return fmt::format("{}/{}_{}", key.scene, key.method, key.ratio);
}

/// `folder`/dataset with scene.json files, and `folder`/results.
inline void write_synthetic_sweep(const fs::path& folder, const SyntheticSweep& sweep) {
  nlohmann::json scenes = nlohmann::json::array();
  for (const std::string& set : sweep.sets)
    for (const int tubes : sweep.tubes)
      for (int number = 1; number <= sweep.cases; ++number) {
        const std::string name = scene_name(set, tubes, number);
        scenes.push_back(name);
        const scene::SceneRecord scene = synthetic_scene(name, tubes, sweep.cylinders);
        const std::string scene_text = scene::format_scene_json(scene);
        write_text(folder / "dataset" / name / "scene.json", scene_text);
        const std::string model = model_json(scene).dump();
        for (const std::string& method : sweep.methods)
          for (const double ratio : sweep.ratios) {
            const evaluation::RunKey key{name, set, tubes, number, method, ratio};
            const fs::path run = folder / "results" / run_folder(key);
            nlohmann::json result = result_json(key);
            result["scene_json_xxh128"] = record_bytes(scene_text).xxh128;
            write_text(run / "result.json", result.dump(1));
            write_text(run / "model.json", model);
            write_text(run / "times.json", nlohmann::json{{"read", 0.001}, {"total", modelling_seconds(key)}}.dump());
          }
      }
  const nlohmann::json index = {{"format", "tubebin results 1"},
                                {"tool_version", "0.1.0"},
                                {"dataset", "../dataset"},
                                {"methods", sweep.methods},
                                {"ratios", sweep.ratios},
                                {"seed", 1},
                                {"scenes", scenes},
                                {"options", {{"radius", 0.0125}}}};
  write_text(folder / "results" / "index.json", index.dump(2));
}

}  // namespace tubebin::testing
