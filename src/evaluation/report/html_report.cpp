#include "tubebin/evaluation/html_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "tubebin/evaluation/result_plots.hpp"
#include "tubebin/evaluation/result_tables.hpp"

namespace tubebin::evaluation {
namespace {

constexpr std::size_t kWorstRuns = 4;
constexpr std::size_t kBestRuns = 1;

constexpr const char* kHead = R"html(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
<title>tubebin evaluation</title>
<style>
:root { --ink: #1d2430; --soft: #5b6472; --line: #d5d9e0; --accent: #0072b2; }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1.5rem 1rem 4rem; max-width: 72rem; color: var(--ink); background: #fff;
       font: 16px/1.5 system-ui, -apple-system, "Segoe UI", Helvetica, Arial, sans-serif; }
h1 { font-size: 1.7rem; margin: 0 0 .25rem; }
h2 { font-size: 1.25rem; margin: 2.5rem 0 .75rem; padding-top: .75rem; border-top: 2px solid var(--line); }
h3 { font-size: 1.05rem; margin: 1.5rem 0 .5rem; }
nav { margin: 1rem 0; display: flex; flex-wrap: wrap; gap: .25rem 1.25rem; }
a { color: var(--accent); }
.soft, .note { color: var(--soft); font-size: .9rem; }
.cards { display: grid; grid-template-columns: repeat(auto-fit, minmax(11rem, 1fr)); gap: .75rem; margin: 1rem 0; }
.card { border: 1px solid var(--line); border-radius: .5rem; padding: .7rem .9rem; }
.card b { display: block; font-size: 1.5rem; line-height: 1.25; font-variant-numeric: tabular-nums; }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 30rem), 1fr)); gap: 1rem; }
.plots figure { margin: 0; border: 1px solid var(--line); border-radius: .5rem; padding: .5rem; }
.plots svg { display: block; width: 100%; height: auto; }
.table { overflow-x: auto; margin: 0 0 1.5rem; }
table { border-collapse: collapse; font-size: .875rem; font-variant-numeric: tabular-nums; }
caption { text-align: left; font-weight: 600; padding: 0 0 .4rem; white-space: nowrap; }
th, td { padding: .25rem .6rem; border-bottom: 1px solid var(--line); text-align: left; vertical-align: top; }
th { border-bottom-color: var(--ink); white-space: nowrap; }
.number { text-align: right; white-space: nowrap; }
td:first-child { min-width: 9rem; }
td:last-child { white-space: nowrap; }
tbody tr:hover { background: #f3f6fa; }
.scene { margin: 0 0 1.5rem; break-inside: avoid; }
.pictures { display: grid; grid-template-columns: repeat(3, 1fr); gap: .5rem; }
.pictures figure { margin: 0; }
.pictures img { width: 100%; height: auto; border: 1px solid var(--line); display: block; image-rendering: auto; }
figcaption { font-size: .85rem; color: var(--soft); padding-top: .2rem; }
pre { overflow-x: auto; background: #f6f7f9; border: 1px solid var(--line); border-radius: .5rem; padding: .75rem; font-size: .8rem; }
summary { cursor: pointer; font-weight: 600; margin: .5rem 0; }
.gaps { border-left: 4px solid #d55e00; padding: .25rem 0 .25rem .9rem; }
@media (max-width: 40rem) { .pictures { grid-template-columns: 1fr; } .plots svg { font-size: 20px; } h1 { font-size: 1.4rem; } }
@media print { body { max-width: none; padding: 0; font-size: 10pt; } nav { display: none; } .table { overflow: visible; }
  table { font-size: 7.5pt; } th, td { padding: 1pt 3pt; } .plots figure, .card { break-inside: avoid; } }
</style>
</head>
<body>
)html";

std::string base64(const std::string& bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) {
      return k < bytes.size() ? static_cast<std::uint8_t>(bytes[k]) : std::uint8_t{0};
    };
    const std::uint32_t group = static_cast<std::uint32_t>(byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2));
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string card(const std::string& value, const std::string& label) {
  return fmt::format("<div class=\"card\"><b>{}</b>{}</div>\n", escape_html(value), escape_html(label));
}

std::string section(const char* id, const char* title, const std::string& content) {
  return content.empty() ? "" : fmt::format("<section id=\"{0}\"><h2>{1}</h2>\n{2}</section>\n", id, title, content);
}

std::string names_list(const std::vector<std::string>& names, const std::string& summary) {
  if (names.empty()) return "";
  std::string html = fmt::format("<details class=\"gaps\"><summary>{}</summary><ul>\n", escape_html(summary));
  for (const std::string& name : names) html += fmt::format("<li>{}</li>\n", escape_html(name));
  return html + "</ul></details>\n";
}

std::string summary_html(const Evaluation& evaluation, const std::vector<GroupSummary>& groups) {
  std::set<std::string> scenes;
  for (const RunScore& run : evaluation.runs) scenes.insert(run.key.scene);
  std::string html = "<div class=\"cards\">\n";
  html += card(fmt::format("{}", scenes.size()), "scenes");
  html += card(fmt::format("{}", evaluation.runs.size()), "runs");
  for (const std::string& method : methods_of(groups)) {
    std::vector<const RunScore*> runs;
    for (const RunScore& run : evaluation.runs)
      if (run.key.method == method) runs.push_back(&run);
    const GroupSummary all = summarize_together(method, "", runs);
    html += card(fmt::format("{:.4f}", all.micro_recall.mean), fmt::format("mean micro-recall, {}", method));
    if (all.seconds)
      html += card(fmt::format("{:.3f} s", all.seconds->mean), fmt::format("mean time a run, {}", method));
  }
  html += "</div>\n";
  html += names_list(evaluation.missing,
                     fmt::format("{} {}", evaluation.missing.size(),
                                 evaluation.missing_counts_as_zero ? "scenes without a prediction count as zero"
                                                                   : "runs are not there and are left out"));
  html += names_list(evaluation.failed, fmt::format("{} runs failed and count as zero", evaluation.failed.size()));
  for (const std::string& note : evaluation.notes) html += fmt::format("<p class=\"gaps\">{}</p>\n", escape_html(note));
  return html + format_html(transpose(overview_table(evaluation), 2));
}

std::string plots_html(const ReportInput& input, const std::vector<GroupSummary>& groups) {
  const std::vector<Plot> plots =
      input.generation == nullptr ? result_plots(groups) : paper_plots(groups, *input.generation);
  if (plots.empty()) return "";
  std::string html = "<div class=\"plots\">\n";
  for (const Plot& plot : plots) html += fmt::format("<figure id=\"{}\">{}</figure>\n", plot.name, format_svg(plot));
  return html + fmt::format("</div>\n<p class=\"note\">Bars are 95 % bootstrap intervals.{}</p>\n",
                            input.generation == nullptr
                                ? ""
                                : " Hollow markers and dotted lines are the paper's values, measured "
                                  "by its authors on an Intel i7-8750H.");
}

std::string tables_html(const std::vector<Table>& tables) {
  std::string html;
  for (const Table& table : tables) html += format_html(table);
  return html;
}

std::string paper_html(const ReportInput& input, const std::vector<GroupSummary>& groups) {
  if (input.generation == nullptr) return "";
  return tables_html(paper_tables(input.evaluation, groups, *input.generation));
}

std::string image(const std::string& png, const ScenePicture& picture, const char* what) {
  return fmt::format(
      "<figure><img width=\"{0}\" height=\"{1}\" alt=\"{2}\" "
      "src=\"data:image/png;base64,{3}\"><figcaption>{2}</figcaption></figure>\n",
      picture.width, picture.height, what, base64(png));
}

std::string pictures_html(const ReportInput& input) {
  if (!input.read_points) return "";
  std::string html;
  for (const RunScore* run : pictured_runs(input.evaluation.runs)) {
    const auto points = input.read_points(*run);
    if (!points) continue;
    const ScenePicture picture = draw_scene(*points);
    html += fmt::format(
        "<div class=\"scene\"><h3>{}: micro-recall {:.4f}, {}, {} found</h3>\n<div "
        "class=\"pictures\">\n",
        escape_html(run->key.name()), run->micro_recall, count_of_tubes(static_cast<int>(run->scores.tubes.size())),
        run->scores.predicted_tubes);
    html += image(picture.truth, picture, "ground truth") +
            image(picture.labels, picture, "labels, coloured as the matched tubes") +
            image(picture.errors, picture, "wrong points orange, points without a label black") + "</div></div>\n";
  }
  if (html.empty()) return "";
  return "<p class=\"note\">The worst scenes of each method, then its best one; labels without a tube are "
         "grey.</p>\n" +
         html;
}

}  // namespace

std::vector<const RunScore*> pictured_runs(const std::vector<RunScore>& runs) {
  std::map<std::string, std::vector<const RunScore*>> by_method;
  for (const RunScore& run : runs)
    if (!run.failed) by_method[run.key.method].push_back(&run);
  std::vector<const RunScore*> chosen;
  for (auto& [method, members] : by_method) {
    std::stable_sort(members.begin(), members.end(),
                     [](const RunScore* a, const RunScore* b) { return a->micro_recall < b->micro_recall; });
    std::set<std::string> scenes;
    const auto choose = [&](auto first, auto last, std::size_t count) {
      for (auto run = first; run != last && count > 0; ++run)
        if (scenes.insert((*run)->key.scene).second) {
          chosen.push_back(*run);
          --count;
        }
    };
    choose(members.begin(), members.end(), kWorstRuns);
    choose(members.rbegin(), members.rend(), kBestRuns);
  }
  return chosen;
}

std::string format_html_report(const ReportInput& input) {
  const Evaluation& evaluation = input.evaluation;
  const std::vector<GroupSummary> groups = summarize(evaluation.runs);
  std::string html = kHead;
  html += fmt::format("<header><h1>How well the tubes were found</h1>\n<p class=\"soft\">{}, tubebin {}</p></header>\n",
                      escape_html(evaluation.source), TUBEBIN_VERSION);
  html += "<nav><a href=\"#summary\">Summary</a><a href=\"#plots\">Plots</a>";
  if (input.generation != nullptr) html += "<a href=\"#paper\">Against the paper</a>";
  html +=
      "<a href=\"#tables\">Tables</a><a href=\"#scenes\">Scenes</a><a "
      "href=\"#configuration\">Configuration</a></nav>\n<main>\n";
  html += section("summary", "Summary", summary_html(evaluation, groups));
  html += section("plots", "Plots", plots_html(input, groups));
  html += section("paper", "Against the paper", paper_html(input, groups));
  html += section("tables", "Tables",
                  (input.generation == nullptr ? tables_html(condition_tables(groups)) : "") +
                      tables_html(detail_tables(evaluation, groups)));
  html += section("scenes", "Worst and best scenes", pictures_html(input));
  if (!evaluation.configuration.empty())
    html += section("configuration", "Configuration",
                    fmt::format("<pre>{}</pre>\n", escape_html(evaluation.configuration)));
  return html + "</main>\n</body>\n</html>\n";
}

}  // namespace tubebin::evaluation
