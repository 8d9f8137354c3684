#include "tubebin/evaluation/run_score.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace tubebin::evaluation {
namespace {

/// The scene's index of the tube with this label, if the scene has it.
std::optional<std::size_t> tube_index(SegmentId label, std::size_t tube_count) {
  if (label == 0 || label > tube_count) return std::nullopt;
  return label - 1;
}

int visibility_class(double visible_fraction) {
  return std::min(kVisibilityClasses - 1, static_cast<int>(visible_fraction * kVisibilityClasses));
}

void add_scene_facts(TubeScore& score, const SceneTruth& truth, const std::vector<Centerline>& model) {
  const auto tube = tube_index(score.truth_id, truth.centerlines.size());
  if (!tube) return;
  score.visible_fraction = truth.samples[*tube].visible_fraction();
  if (!score.predicted_id) return;
  const auto modelled = tube_index(*score.predicted_id, model.size());
  if (!modelled) return;
  const Centerline& line = model[*modelled];
  if (std::all_of(line.begin(), line.end(), [](const CenterlineSegment& segment) { return segment.bridged; })) return;
  score.centerline_error = centerline_error(truth.centerlines[*tube], truth.samples[*tube], line);
}

/// Which rows of the contingency are tubes of the visibility class.
std::vector<bool> rows_of_class(const Contingency& contingency, const SceneTruth& truth, int wanted) {
  std::vector<bool> rows(contingency.truth_ids.size());
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const auto tube = tube_index(contingency.truth_ids[row], truth.samples.size());
    rows[row] = tube && visibility_class(truth.samples[*tube].visible_fraction()) == wanted;
  }
  return rows;
}

/// The tubes of a class are tubes of the whole, with their facts.
void copy_scene_facts(const std::vector<TubeScore>& whole, std::vector<TubeScore>& part) {
  for (TubeScore& score : part) {
    const auto same = std::find_if(whole.begin(), whole.end(),
                                   [&](const TubeScore& other) { return other.truth_id == score.truth_id; });
    score.visible_fraction = same->visible_fraction;
    score.centerline_error = same->centerline_error;
  }
}

}  // namespace

const char* visibility_class_name(int visibility_class) {
  constexpr const char* names[kVisibilityClasses] = {"0-25 %", "25-50 %", "50-75 %", "75-100 %"};
  return names[visibility_class];
}

std::string RunKey::name() const { return fmt::format("{} {} {}", scene, method, ratio); }

RunKey parse_scene_name(const std::string& name) {
  RunKey key;
  key.scene = name;
  const std::size_t slash = name.find('/');
  const std::string group = name.substr(0, slash);
  key.set = group;
  if (slash == std::string::npos) return key;
  const std::size_t digits = group.find_last_not_of("0123456789") + 1;
  const std::string tubes = group.substr(digits);
  const std::size_t last_slash = name.rfind('/');
  const std::string case_text = name.substr(last_slash + 1);
  int tube_count = 0;
  int case_number = 0;
  const auto parse = [](const std::string& text, int& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc{} && end == text.data() + text.size();
  };
  if (digits == 0 || !parse(tubes, tube_count) || !parse(case_text, case_number)) return key;
  // "A1/12000/12345": from case 1000 on, thousands have folders of their own.
  if (last_slash != slash && name.substr(slash, last_slash - slash) != fmt::format("/{}", case_number / 1000 * 1000))
    return key;
  key.set = group.substr(0, digits);
  key.tubes = tube_count;
  key.case_number = case_number;
  return key;
}

SceneTruth::SceneTruth(const scene::Scene& scene) : samples(sample_centerlines(scene)) {
  for (const scene::PlacedTube& tube : scene.tubes) centerlines.push_back(centerline(tube));
}

RunScore score_run(const RunKey& key, const Contingency& contingency, const Matching& matching, const SceneTruth* truth,
                   const std::vector<Centerline>& model) {
  RunScore run;
  run.key = key;
  run.micro_recall = matching.micro_recall();
  run.scores = score_tubes(contingency, matching);
  if (truth == nullptr) return run;
  for (TubeScore& score : run.scores.tubes) add_scene_facts(score, *truth, model);
  for (int c = 0; c < kVisibilityClasses; ++c) {
    run.by_visibility.push_back(score_tubes(contingency, matching, rows_of_class(contingency, *truth, c)));
    copy_scene_facts(run.scores.tubes, run.by_visibility.back().tubes);
  }
  return run;
}

}  // namespace tubebin::evaluation
