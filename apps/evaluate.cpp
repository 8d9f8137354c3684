/// How well tubes were found: micro-recall and more, for a pair of clouds, a results folder, or any program's
/// labels.
#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <thread>

#include "program.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/shell_word.hpp"
#include "tubebin/dataset/manifest.hpp"
#include "tubebin/evaluation/html_report.hpp"
#include "tubebin/evaluation/result_plots.hpp"
#include "tubebin/evaluation/result_tables.hpp"
#include "tubebin/jobs/progress.hpp"
#include "tubebin/results/labelled_points.hpp"
#include "tubebin/results/predictions.hpp"
#include "tubebin/results/results_folder.hpp"

namespace {

using namespace tubebin;

constexpr const char* kExamples = R"(
Examples:
  evaluate --filtered filtered.pcd --labeled labeled.pcd
      one pair of clouds: its matching and its micro-recall
  evaluate results --html report.html
      the results folder of model_tubes: tables here, plots and pictures in the report
  evaluate results --html report.html --scenes A10/003
      that scene in the report, too, beside the worst ones
  evaluate results_a results_b --paper --plots plots
      both sets together, against the paper's tables, figures and claims
  evaluate results --format csv > groups.csv
      one line for each method, set, number of tubes and ratio, with every measure
  evaluate dataset --predictions my_labels
      any program's labelled clouds (docs/foreign_algorithms.md)
  evaluate results results_told --name estimated --name told
      two settings of one method side by side; without --name, each is called by what differs
  evaluate dataset --predictions mine --predictions yours
      two programs side by side

docs/metrics.md defines every measure.
Exit codes: 0 done; 1 input or output failed; 2 wrong usage; 3 finished, but some scenes or runs have no result (each
is named).)";

const std::map<std::string, evaluation::TableFormat> kFormats = {{"table", evaluation::TableFormat::table},
                                                                 {"markdown", evaluation::TableFormat::markdown},
                                                                 {"csv", evaluation::TableFormat::csv},
                                                                 {"json", evaluation::TableFormat::json}};
const std::map<std::string, evaluation::SegmentField> kFields = {{"auto", evaluation::SegmentField::automatic},
                                                                 {"label", evaluation::SegmentField::label},
                                                                 {"color", evaluation::SegmentField::color}};

template <typename Value>
std::vector<std::string> names_of(const std::map<std::string, Value>& values) {
  std::vector<std::string> names;
  for (const auto& [name, value] : values) names.push_back(name);
  return names;
}

struct Arguments {
  std::vector<std::string> folders;
  std::string filtered;
  std::string labeled;
  std::vector<std::string> predictions;
  std::vector<std::string> names;
  std::string dataset;
  std::string html;
  std::string plots;
  std::vector<std::string> scenes;
  bool paper = false;
  bool quiet = false;
  std::string field = "auto";
  std::string format = "table";
  int jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
};

void add_options(CLI::App& app, Arguments& arguments) {
  auto* folder = app.add_option("FOLDERS", arguments.folders, "Results folders, or a data set with --predictions");
  auto* filtered =
      app.add_option("--filtered", arguments.filtered, "Cloud with the ground truth (PCD or PLY)")->type_name("FILE");
  auto* labeled = app.add_option("--labeled", arguments.labeled, "The same points, or some of them, as labelled")
                      ->type_name("FILE");
  auto* predictions = app.add_option("--predictions", arguments.predictions,
                                     "Labelled clouds of any program, one a scene; repeatable, to compare programs")
                          ->allow_extra_args(false)
                          ->type_name("DIR");
  auto* names = app.add_option("--name", arguments.names,
                               "What tables call the next of the folders; without it, what differs between them")
                    ->allow_extra_args(false)
                    ->type_name("NAME");
  auto* dataset = app.add_option("--dataset", arguments.dataset, "Data set of a results folder, where it was moved")
                      ->type_name("DIR");
  app.add_option("--field", arguments.field, "What tells segments apart")
      ->check(CLI::IsMember(names_of(kFields)))
      ->capture_default_str();
  app.add_option("--format", arguments.format, "Of the tables")
      ->check(CLI::IsMember(names_of(kFormats)))
      ->capture_default_str();
  auto* html = app.add_option("--html", arguments.html,
                              "Also write a report: one file with tables, plots, pictures and scenes in 3D")
                   ->type_name("FILE");
  app.add_option("--scenes", arguments.scenes, "What the report shows beside the worst scenes: A10/003 B10/001")
      ->type_name("SCENE...")
      ->needs(html);
  auto* plots = app.add_option("--plots", arguments.plots, "Also write the plots as .svg files")->type_name("DIR");
  auto* paper = app.add_flag("--paper", arguments.paper, "Compare with the paper: its figures, tables and claims");
  app.add_flag("-q,--quiet", arguments.quiet, "No progress");
  app.add_option("-j,--jobs", arguments.jobs, "Threads")->check(CLI::Range(1, 1024))->capture_default_str();
  filtered->needs(labeled)->excludes(folder)->excludes(predictions);
  labeled->needs(filtered);
  predictions->needs(folder)->excludes(dataset);
  for (CLI::Option* option : {names, dataset, html, plots, paper}) option->needs(folder);
}

int evaluate_pair(const Arguments& arguments) {
  const cloud::Cloud filtered = cloud::read_cloud(arguments.filtered);
  const cloud::Cloud labeled = cloud::read_cloud(arguments.labeled);
  const evaluation::PairedIds pairs = evaluation::pair_clouds(
      {filtered, arguments.filtered}, {labeled, arguments.labeled}, kFields.at(arguments.field));
  fmt::print("{}", evaluation::format_pair(pairs, kFormats.at(arguments.format)));
  return static_cast<int>(ExitCode::done);
}

/// Names the first few one by one.
void print_names(const std::vector<std::string>& names, const char* what) {
  constexpr std::size_t shown = 20;
  if (names.empty()) return;
  fmt::print(stderr, "evaluate: {} {}\n", names.size(), what);
  for (std::size_t i = 0; i < std::min(names.size(), shown); ++i) fmt::print(stderr, "  {}\n", names[i]);
  if (names.size() > shown) fmt::print(stderr, "  and {} more (--format json names all)\n", names.size() - shown);
}

void print_gaps(const evaluation::Evaluation& evaluation) {
  print_names(evaluation.missing, evaluation.missing_counts_as_zero ? "scenes have no prediction and count as zero:"
                                                                    : "runs are not there yet and are left out:");
  if (!evaluation.unfinished_calls.empty()) fmt::print(stderr, "To make exactly what is missing:\n");
  for (const std::vector<std::string>& folders : evaluation.unfinished_calls) {
    std::string command = "model_tubes --resume";
    for (const std::string& folder : folders) command += fmt::format(" {}", shell_path(folder));
    fmt::print(stderr, "  {}\n", command);
  }
  print_names(evaluation.failed, "runs failed and count as zero:");
  for (const std::string& note : evaluation.notes) fmt::print(stderr, "evaluate: {}\n", note);
}

evaluation::Evaluation read_evaluation(const Arguments& arguments) {
  std::optional<jobs::Progress> progress;
  const evaluation::OnProgress on_progress = [&](std::size_t done, std::size_t total) {
    if (done == 1)
      progress.emplace(total, "scenes",
                       arguments.quiet ? jobs::Progress::Style::none : jobs::Progress::Style::automatic);
    progress->count_done();
    progress->show();
  };
  if (arguments.predictions.empty())
    return results::read_results(arguments.folders, {arguments.dataset, arguments.jobs, on_progress, arguments.names});
  if (arguments.folders.size() > 1) throw_config_error("--predictions takes one data set");
  return results::score_predictions(arguments.folders.front(), arguments.predictions,
                                    {kFields.at(arguments.field), arguments.jobs, on_progress, arguments.names});
}

/// What the manifests of the runs' data sets say.
evaluation::GenerationSeconds generation_seconds(const evaluation::Evaluation& evaluation) {
  std::set<std::string> datasets;
  for (const evaluation::RunScore& run : evaluation.runs)
    if (!run.dataset.empty()) datasets.insert(run.dataset);
  evaluation::GenerationSeconds seconds;
  for (const std::string& dataset : datasets) {
    const dataset::Manifest manifest(dataset);
    for (const auto& [id, record] : manifest.records())
      if (const auto total = record.seconds.find("total"); total != record.seconds.end())
        seconds[evaluation::parse_scene_name(id).set][record.tubes].push_back(total->second);
  }
  return seconds;
}

void write_plots(const std::string& folder, const std::vector<evaluation::Plot>& plots) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw_io_error("{}: cannot be made: {}", folder, error.message());
  for (const evaluation::Plot& plot : plots)
    write_file_atomically(folder + "/" + plot.name + ".svg", evaluation::format_svg(plot));
}

std::vector<evaluation::Plot> plots_of(const evaluation::Evaluation& evaluation,
                                       const evaluation::GenerationSeconds* generation) {
  const std::vector<evaluation::GroupSummary> groups = evaluation::summarize(evaluation.runs);
  return generation == nullptr ? evaluation::result_plots(groups) : evaluation::paper_plots(groups, *generation);
}

int evaluate_folders(const Arguments& arguments) {
  const evaluation::Evaluation evaluation = read_evaluation(arguments);
  std::optional<evaluation::GenerationSeconds> paper;
  if (arguments.paper) paper = generation_seconds(evaluation);
  const evaluation::GenerationSeconds* generation = paper ? &*paper : nullptr;
  fmt::print("{}", evaluation::format_results(evaluation, kFormats.at(arguments.format), generation));
  print_gaps(evaluation);
  if (!arguments.html.empty())
    write_file_atomically(arguments.html, evaluation::format_html_report(
                                              {evaluation, generation, results::labelled_points, arguments.scenes}));
  if (!arguments.plots.empty()) write_plots(arguments.plots, plots_of(evaluation, generation));
  const bool is_complete = evaluation.missing.empty() && evaluation.failed.empty();
  return static_cast<int>(is_complete ? ExitCode::done : ExitCode::incomplete);
}

int run(const Arguments& arguments) {
  if (!arguments.filtered.empty()) return evaluate_pair(arguments);
  if (arguments.folders.empty()) throw_usage_error("a results folder, or --filtered and --labeled, is needed");
  return evaluate_folders(arguments);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Measures how well tubes were found in point clouds.");
  app.footer(kExamples);
  app.set_version_flag("--version", "tubebin " TUBEBIN_VERSION);
  add_options(app, arguments);
  return run_program("evaluate", app, argc, argv, [&] { return run(arguments); });
}
