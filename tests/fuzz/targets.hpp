/// What a fuzzer calls with any bytes, one function a reader. A reader may refuse its input with the error
/// that it documents, and with no other; what it accepts must survive a round trip.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "results/result_files.hpp"
#include "results/results_index.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/yaml.hpp"
#include "tubebin/evaluation/metrics.hpp"
#include "tubebin/evaluation/run_score.hpp"
#include "tubebin/scene/scene_json.hpp"
#include "tubebin/scene/tubes_txt.hpp"
#include "tubebin/tube/tube_generator.hpp"

namespace tubebin::fuzz {

inline void require(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "broken: %s\n", what);
  std::abort();
}

/// A NaN is as good as any other.
inline bool same_points(const std::vector<cloud::Point>& a, const std::vector<cloud::Point>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      if (a[i][axis] != b[i][axis] && !(a[i][axis] != a[i][axis] && b[i][axis] != b[i][axis])) return false;
  return true;
}

inline void cloud(std::string_view bytes) {
  cloud::Cloud cloud;
  try {
    cloud = cloud::parse_cloud(bytes, "fuzz");
  } catch (const IoError&) {
    return;
  }
  for (const cloud::CloudFormat format : {cloud::CloudFormat::pcd_binary, cloud::CloudFormat::pcd_compressed,
                                          cloud::CloudFormat::pcd_ascii, cloud::CloudFormat::ply_binary}) {
    const cloud::Cloud back = cloud::parse_cloud(cloud::format_cloud(cloud, format), "round trip");
    require(same_points(back.points, cloud.points), "points read back");
    require(back.colors == cloud.colors && back.labels == cloud.labels, "colours and labels read back");
    require(back.width == cloud.width && back.height == cloud.height, "rows and columns read back");
  }
}

inline void tubes_txt(std::string_view bytes) {
  std::vector<scene::PlacedTube> tubes;
  try {
    tubes = scene::parse_tubes_txt(bytes, "fuzz");
  } catch (const IoError&) {
    return;
  }
  const std::string text = scene::format_tubes_txt(tubes);
  require(scene::format_tubes_txt(scene::parse_tubes_txt(text, "round trip")) == text, "tubes read back");
}

inline void scene_json(std::string_view bytes) {
  scene::SceneRecord record;
  try {
    record = scene::parse_scene_json(bytes, "fuzz");
  } catch (const IoError&) {
    return;
  }
  const std::string text = scene::format_scene_json(record);
  require(scene::format_scene_json(scene::parse_scene_json(text, "round trip")) == text, "the scene reads back");
}

inline void result_index(std::string_view bytes) {
  try {
    results::parse_results_index(bytes, "fuzz");
  } catch (const IoError&) {
  }
}

inline void failures(std::string_view bytes) {
  try {
    results::parse_failures(bytes, "fuzz");
  } catch (const IoError&) {
  }
}

/// Two tubes that cross, as ground truth.
inline const evaluation::SceneTruth& two_tubes() {
  static const evaluation::SceneTruth truth = [] {
    scene::PlacedTube along, across;
    along.tube = {.radius = 0.01,
                  .nodes = {{-0.1, 0.0, 0.0}, {0.1, 0.0, 0.0}},
                  .cylinders = {{.node_a = 0, .node_b = 1, .order = 0}}};
    across.tube = {.radius = 0.01,
                   .nodes = {{0.0, -0.1, 0.03}, {0.0, 0.1, 0.03}},
                   .cylinders = {{.node_a = 0, .node_b = 1, .order = 0}}};
    scene::Scene scene;
    scene.tubes = {along, across};
    return evaluation::SceneTruth(scene);
  }();
  return truth;
}

inline bool is_share(double value) { return value >= 0.0 && value <= 1.0; }

inline void parse_labeling_tubes(std::string_view model) {
  try {
    results::parse_labeling_tubes(model, "fuzz model");
  } catch (const IoError&) {
  }
}

/// result.json, a line "---" and model.json, which are scored as `evaluate` does.
inline void run(std::string_view bytes) {
  constexpr std::string_view kDivider = "\n---\n";
  const std::size_t divider = bytes.find(kDivider);
  if (divider != std::string_view::npos) parse_labeling_tubes(bytes.substr(divider + kDivider.size()));
  evaluation::RunScore score;
  try {
    const results::RunCounts counts = results::parse_run_counts(bytes.substr(0, divider), "fuzz result");
    std::vector<evaluation::Centerline> model;
    if (divider != std::string_view::npos)
      for (const evaluation::TubeLine& tube :
           results::parse_model_tubes(bytes.substr(divider + kDivider.size()), "fuzz model"))
        model.push_back(tube.centerline);
    score = evaluation::score_run({}, counts.contingency, evaluation::match_segments(counts.contingency), &two_tubes(),
                                  model);
  } catch (const IoError&) {
    return;
  }
  require(is_share(score.micro_recall), "micro-recall is a share");
  for (const evaluation::TubeScore& tube : score.scores.tubes)
    require(is_share(tube.recall()) && is_share(tube.precision()) && is_share(tube.iou()), "measures are shares");
}

inline void times(std::string_view bytes) {
  try {
    require(results::parse_modeling_seconds(bytes, "fuzz") >= 0.0, "a time is not negative");
  } catch (const IoError&) {
  }
}

/// An options struct with a field of every kind.
struct Options {
  std::uint64_t seed = 1;
  bool flag = false;
  std::string text = "text";
  std::vector<int> integers = {1};
  tube::TubeOptions tube;
  scene::Bin bin;
  scene::Scanner scanner;
};

inline void describe_all(Fields& fields, Options& options) {
  fields.seed("seed", options.seed, "");
  fields.flag("flag", options.flag, "");
  fields.text("text", options.text, "");
  fields.integers("integers", options.integers, {0, 1000}, "");
  fields.group("tube", "", [&](Fields& inner) { describe(inner, options.tube); });
  fields.group("bin", "", [&](Fields& inner) { describe(inner, options.bin); });
  fields.group("scanner", "", [&](Fields& inner) { describe(inner, options.scanner); });
}

inline void yaml(std::string_view bytes) {
  Options options;
  const auto read = [](const std::string& text, Options& into) {
    read_yaml_text(text, "fuzz", [&](Fields& fields) { describe_all(fields, into); });
  };
  const auto write = [](Options& from) { return write_yaml([&](Fields& fields) { describe_all(fields, from); }); };
  try {
    read(std::string(bytes), options);
  } catch (const ConfigError&) {
    return;
  }
  const std::string text = write(options);
  Options back;
  read(text, back);
  require(write(back) == text, "the options read back");
}

}  // namespace tubebin::fuzz
