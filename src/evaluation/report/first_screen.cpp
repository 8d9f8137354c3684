#include "evaluation/report/first_screen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "evaluation/report/base64.hpp"
#include "evaluation/report/verdict.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/evaluation/plot.hpp"
#include "tubebin/evaluation/scene_view.hpp"
#include "tubebin/evaluation/table.hpp"

namespace tubebin::evaluation {
namespace {

constexpr double kWidestBar = 0.05;  // the histogram shows at least 0.95 to 1
constexpr int kBarsPerTick = 4;
constexpr std::size_t kMostRows = 2000;  // of the table of scenes

std::map<std::string, std::vector<SceneSummary>> scenes_by_method(const Evaluation& evaluation) {
  std::map<std::string, std::vector<SceneSummary>> scenes;
  for (SceneSummary& scene : summarize_scenes(evaluation.runs)) scenes[scene.method].push_back(std::move(scene));
  return scenes;
}

/// Scenes by micro-recall, from `low` to 1.
std::string histogram_html(const std::vector<SceneSummary>& scenes, double low) {
  const std::vector<double> ticks = linear_ticks(low, 1.0);
  const std::size_t bars = (ticks.size() - 1) * kBarsPerTick;
  const double width = (1.0 - ticks.front()) / static_cast<double>(bars);
  std::vector<int> counts(bars);
  for (const SceneSummary& scene : scenes)
    ++counts[std::min(bars - 1, static_cast<std::size_t>((scene.micro_recall - ticks.front()) / width))];
  const int highest = *std::max_element(counts.begin(), counts.end());
  std::string html = fmt::format(
      "<figure class=\"histogram\"><div class=\"bars\" role=\"img\" aria-label=\"Histogram of {} scenes by "
      "micro-recall\">",
      scenes.size());
  for (std::size_t i = 0; i < bars; ++i) {
    const double from = ticks.front() + width * static_cast<double>(i);
    html += fmt::format("<span style=\"height:{}%\" title=\"{:.4g} to {:.4g}: {}\"></span>", 100 * counts[i] / highest,
                        from, from + width, counts[i]);
  }
  return html + fmt::format(
                    "</div>\n<div class=\"ends\"><span>{:.4g}</span><span>micro-recall</span><span>1</span></div>\n"
                    "<figcaption>{} scenes; the highest bar is {}.</figcaption></figure>\n",
                    ticks.front(), scenes.size(), highest);
}

std::string image(const std::string& png, const ScenePicture& picture, const char* caption) {
  return fmt::format(
      "<figure><img width=\"{0}\" height=\"{1}\" alt=\"{2}\" "
      "src=\"data:image/png;base64,{3}\"><figcaption>{2}</figcaption></figure>\n",
      picture.width, picture.height, caption, base64(png));
}

std::string scene_html(const ReportInput& input, const RunScore& run) {
  std::string html = fmt::format("<div class=\"scene\"><h3>{}: micro-recall {:.4f}, {}, {} found</h3>\n<p>{}</p>\n",
                                 escape_html(run.key.name()), run.micro_recall,
                                 count_of_tubes(static_cast<int>(run.scores.tubes.size())), run.scores.predicted_tubes,
                                 escape_html(describe_errors(run)));
  const auto points = input.read_points ? input.read_points(run) : std::nullopt;
  if (!points) return html + "<p class=\"note\">No picture: its clouds are not there.</p></div>\n";
  const ScenePicture picture = draw_scene(*points);
  return html + "<div class=\"pictures\">\n" + image(picture.truth, picture, "ground truth") +
         image(picture.labels, picture, "found, in the colour of the matched tube; grey: no tube's") +
         image(picture.errors, picture, "wrong points orange, points without a label black") + "</div>\n" +
         view_figure({run.key.name(), *points}) + "</div>\n";
}

}  // namespace

std::string verdict_html(const Evaluation& evaluation) {
  const auto scenes = scenes_by_method(evaluation);
  double low = 1.0 - kWidestBar;
  for (const auto& [method, members] : scenes) low = std::min(low, members.front().micro_recall);
  std::string html;
  for (const auto& [method, members] : scenes) {
    std::vector<const RunScore*> runs;
    for (const RunScore& run : evaluation.runs)
      if (run.key.method == method) runs.push_back(&run);
    const VerdictText text = describe_results(runs, members);
    html += fmt::format("<div class=\"verdict\"><div><h2>{}</h2>\n<p>{}</p>\n<p>{}</p>\n<p>{}</p></div>\n{}</div>\n",
                        escape_html(text.headline), escape_html(text.how_good), escape_html(text.how_sure),
                        escape_html(text.where_it_fails), histogram_html(members, low));
  }
  return html;
}

std::string scenes_html(const ReportInput& input, const std::vector<const RunScore*>& runs) {
  std::string html;
  for (const RunScore* run : runs) html += scene_html(input, *run);
  return html;
}

std::string scene_table_html(const Evaluation& evaluation) {
  std::vector<SceneSummary> scenes = summarize_scenes(evaluation.runs);
  std::stable_sort(scenes.begin(), scenes.end(),
                   [](const SceneSummary& a, const SceneSummary& b) { return a.micro_recall < b.micro_recall; });
  Table table{fmt::format("{} scenes, the worst first", scenes.size()),
              {"scene", "method", "tubes", "found whole", "micro-recall", "lowest", "at ratio", "wrong points are"},
              {},
              ""};
  if (scenes.size() > kMostRows) {
    table.note = fmt::format("The {} worst of {} are shown.", kMostRows, scenes.size());
    scenes.resize(kMostRows);
  }
  for (const SceneSummary& scene : scenes)
    table.rows.push_back({scene.scene, scene.method, integer_cell(scene.tubes), percent_cell(scene.detected),
                          number_cell(scene.micro_recall, 4), number_cell(scene.worst->micro_recall, 4),
                          Cell(fmt::format("{}", scene.worst->key.ratio), scene.worst->key.ratio),
                          reasons_text(scene.lost)});
  return "<div class=\"scenes\">\n" + format_html(table) + "</div>\n";
}

std::vector<const RunScore*> pictured_runs(const std::vector<RunScore>& runs) {
  constexpr std::size_t most = 3;
  std::map<std::string, std::vector<const RunScore*>> by_method;
  for (const RunScore& run : runs)
    if (!run.failed) by_method[run.key.method].push_back(&run);
  std::vector<const RunScore*> chosen;
  for (auto& [method, members] : by_method) {
    std::stable_sort(members.begin(), members.end(),
                     [](const RunScore* a, const RunScore* b) { return a->micro_recall < b->micro_recall; });
    std::set<std::string> scenes;
    for (const RunScore* run : members)
      if (scenes.size() < most && scenes.insert(run->key.scene).second) chosen.push_back(run);
  }
  return chosen;
}

std::vector<const RunScore*> runs_of_scenes(const std::vector<RunScore>& runs, const std::vector<std::string>& scenes) {
  std::vector<const RunScore*> chosen;
  for (const std::string& scene : scenes) {
    std::map<std::string, const RunScore*> worst;
    for (const RunScore& run : runs) {
      if (run.key.scene != scene || run.failed) continue;
      const RunScore*& so_far = worst[run.key.method];
      if (so_far == nullptr || run.micro_recall < so_far->micro_recall) so_far = &run;
    }
    if (worst.empty())
      throw_config_error("scene '{}' has no result{}", scene,
                         runs.empty() ? "" : fmt::format("; one that has is {}", runs.front().key.scene));
    for (const auto& [method, run] : worst) chosen.push_back(run);
  }
  return chosen;
}

}  // namespace tubebin::evaluation
