#include "tubebin/evaluation/html_report.hpp"

#include <fmt/format.h>

#include "evaluation/report/first_screen.hpp"
#include "evaluation/report/measures.hpp"
#include "evaluation/report/page_head.hpp"
#include "evaluation/report/side_by_side.hpp"
#include "tubebin/evaluation/result_plots.hpp"
#include "tubebin/evaluation/result_tables.hpp"
#include "tubebin/evaluation/scene_view.hpp"

extern const char* const kReportJs;  // data/report/report.js

namespace tubebin::evaluation {
namespace {

struct Section {
  const char* id;
  const char* title;
  std::string content;  ///< empty: the report has no such section
};

std::string section_html(const Section& section) {
  return section.content.empty() ? ""
                                 : fmt::format("<section id=\"{}\"><h2>{}</h2>\n{}</section>\n", section.id,
                                               section.title, section.content);
}

std::string names_list(const std::vector<std::string>& names, const std::string& summary) {
  if (names.empty()) return "";
  std::string html = fmt::format("<details class=\"gaps\"><summary>{}</summary><ul>\n", escape_html(summary));
  for (const std::string& name : names) html += fmt::format("<li>{}</li>\n", escape_html(name));
  return html + "</ul></details>\n";
}

/// Results that are not there, and what could not be measured.
std::string gaps_html(const Evaluation& evaluation) {
  std::string html = names_list(
      evaluation.missing, fmt::format("{} {}", evaluation.missing.size(),
                                      evaluation.missing_counts_as_zero ? "scenes without a prediction count as zero"
                                                                        : "runs are not there and are left out"));
  html += names_list(evaluation.failed, fmt::format("{} runs failed and count as zero", evaluation.failed.size()));
  for (const std::string& note : evaluation.notes) html += fmt::format("<p class=\"gaps\">{}</p>\n", escape_html(note));
  return html;
}

std::string side_by_side_html(const Evaluation& evaluation) {
  const std::vector<Comparison> comparisons = compare_methods(evaluation.runs);
  return comparisons.empty() ? "" : format_html(side_by_side_table(comparisons));
}

/// The overview with a sentence beside each measure.
std::string measures_html(const Evaluation& evaluation) {
  Table table = transpose(overview_table(evaluation), 2);
  table.headers.front() = "measure";
  table.headers.emplace_back("meaning");
  for (auto& row : table.rows) row.emplace_back(sentence_of(row.front().text));
  return format_html(table);
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

}  // namespace

std::string format_html_report(const ReportInput& input) {
  const Evaluation& evaluation = input.evaluation;
  const std::vector<GroupSummary> groups = summarize(evaluation.runs);
  const Section sections[] = {
      {"chosen", "Chosen scenes", scenes_html(input, runs_of_scenes(evaluation.runs, input.scenes))},
      {"worst", "Worst scenes", scenes_html(input, pictured_runs(evaluation.runs))},
      {"side_by_side", "Side by side", side_by_side_html(evaluation)},
      {"scenes", "All scenes", scene_table_html(evaluation)},
      {"measures", "Measures", measures_html(evaluation)},
      {"plots", "Plots", plots_html(input, groups)},
      {"paper", "Against the paper", paper_html(input, groups)},
      {"tables", "Tables",
       (input.generation == nullptr ? tables_html(condition_tables(groups)) : "") +
           tables_html(detail_tables(evaluation, groups))},
      {"configuration", "Configuration",
       evaluation.configuration.empty()
           ? ""
           : fmt::format("<pre tabindex=\"0\">{}</pre>\n", escape_html(evaluation.configuration))}};
  std::string html = page_head("tubebin evaluation", view_style());
  html += fmt::format("<header><h1>How well the tubes were found</h1>\n<p class=\"soft\">{}, tubebin {}</p>\n<nav>",
                      escape_html(evaluation.source), TUBEBIN_VERSION);
  for (const Section& section : sections)
    if (!section.content.empty()) html += fmt::format("<a href=\"#{}\">{}</a>\n", section.id, section.title);
  html += "</nav></header>\n<main>\n<section id=\"verdict\">" + verdict_html(evaluation) + gaps_html(evaluation) +
          "</section>\n";
  for (const Section& section : sections) html += section_html(section);
  if (html.find("class=\"view\"") != std::string::npos) html += view_script();
  return html + fmt::format("</main>\n<script>\n{}</script>\n</body>\n</html>\n", kReportJs);
}

}  // namespace tubebin::evaluation
