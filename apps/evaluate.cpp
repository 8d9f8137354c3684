/// How well tubes were found: micro-recall and more, for a pair of clouds, a results folder, or any program's
/// labels.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <thread>

#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/evaluation/predictions.hpp"
#include "tubebin/evaluation/result_tables.hpp"
#include "tubebin/evaluation/results_folder.hpp"

namespace {

using namespace tubebin;

constexpr const char* kExamples = R"(
Examples:
  evaluate --filtered filtered.pcd --labeled labeled.pcd
      one pair of clouds: its matching and its micro-recall
  evaluate results --html report.html
      the results folder of model_tubes: tables here, plots and pictures in the report
  evaluate results --format csv > groups.csv
      one line for each method, set, number of tubes and ratio, with every measure
  evaluate dataset --predictions my_labels
      any program's labelled clouds (docs/foreign_algorithms.md)

docs/metrics.md defines every measure.
Exit codes: 0 done; 1 input or output failed; 2 wrong usage; 3 finished, but some scenes or runs have no result (each
is named).)";

const std::map<std::string, TableFormat> kFormats = {{"table", TableFormat::table},
                                                     {"markdown", TableFormat::markdown},
                                                     {"csv", TableFormat::csv},
                                                     {"json", TableFormat::json}};
const std::map<std::string, SegmentField> kFields = {
    {"auto", SegmentField::automatic}, {"label", SegmentField::label}, {"color", SegmentField::color}};

template <typename Value>
std::vector<std::string> names_of(const std::map<std::string, Value>& values) {
  std::vector<std::string> names;
  for (const auto& [name, value] : values) names.push_back(name);
  return names;
}

struct Arguments {
  std::string folder;
  std::string filtered;
  std::string labeled;
  std::string predictions;
  std::string dataset;
  std::string field = "auto";
  std::string format = "table";
  int jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
};

void add_options(CLI::App& app, Arguments& arguments) {
  auto* folder = app.add_option("FOLDER", arguments.folder, "Results folder, or data set with --predictions");
  auto* filtered =
      app.add_option("--filtered", arguments.filtered, "Cloud with the ground truth (PCD or PLY)");
  auto* labeled =
      app.add_option("--labeled", arguments.labeled, "The same points, or some of them, as labelled");
  auto* predictions =
      app.add_option("--predictions", arguments.predictions, "Labelled clouds of any program, one a scene")
          ->type_name("DIR");
  auto* dataset =
      app.add_option("--dataset", arguments.dataset, "Data set of a results folder, where it was moved")
          ->type_name("DIR");
  app.add_option("--field", arguments.field, "What tells segments apart")
      ->check(CLI::IsMember(names_of(kFields)))
      ->capture_default_str();
  app.add_option("--format", arguments.format, "Of the tables")
      ->check(CLI::IsMember(names_of(kFormats)))
      ->capture_default_str();
  app.add_option("-j,--jobs", arguments.jobs, "Threads")->check(CLI::Range(1, 1024))->capture_default_str();
  filtered->needs(labeled)->excludes(folder)->excludes(predictions);
  labeled->needs(filtered);
  predictions->needs(folder)->excludes(dataset);
  dataset->needs(folder);
}

int evaluate_pair(const Arguments& arguments) {
  const Cloud filtered = read_cloud(arguments.filtered);
  const Cloud labeled = read_cloud(arguments.labeled);
  const PairedIds pairs =
      pair_clouds({filtered, arguments.filtered}, {labeled, arguments.labeled}, kFields.at(arguments.field));
  fmt::print("{}", format_pair(pairs, kFormats.at(arguments.format)));
  return static_cast<int>(ExitCode::done);
}

/// Names the first few one by one.
void print_names(const std::vector<std::string>& names, const char* what) {
  constexpr std::size_t shown = 20;
  if (names.empty()) return;
  fmt::print(stderr, "evaluate: {} {}\n", names.size(), what);
  for (std::size_t i = 0; i < std::min(names.size(), shown); ++i) fmt::print(stderr, "  {}\n", names[i]);
  if (names.size() > shown)
    fmt::print(stderr, "  and {} more (--format json names all)\n", names.size() - shown);
}

void print_gaps(const Evaluation& evaluation) {
  print_names(evaluation.missing, evaluation.missing_counts_as_zero
                                      ? "scenes have no prediction and count as zero:"
                                      : "runs are not there yet and are left out:");
  print_names(evaluation.failed, "runs failed and count as zero:");
  for (const std::string& note : evaluation.notes) fmt::print(stderr, "evaluate: {}\n", note);
}

int evaluate_folder(const Arguments& arguments) {
  const Evaluation evaluation = arguments.predictions.empty()
                                    ? read_results(arguments.folder, {arguments.dataset, arguments.jobs, {}})
                                    : score_predictions(arguments.folder, arguments.predictions,
                                                        {kFields.at(arguments.field), arguments.jobs, {}});
  fmt::print("{}", format_results(evaluation, kFormats.at(arguments.format)));
  print_gaps(evaluation);
  const bool is_complete = evaluation.missing.empty() && evaluation.failed.empty();
  return static_cast<int>(is_complete ? ExitCode::done : ExitCode::incomplete);
}

int run(const Arguments& arguments) {
  if (!arguments.filtered.empty()) return evaluate_pair(arguments);
  if (arguments.folder.empty())
    throw_config_error("a results folder, or --filtered and --labeled, is needed; --help shows examples");
  return evaluate_folder(arguments);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Measures how well tubes were found in point clouds.");
  app.footer(kExamples);
  app.set_version_flag("--version", "tubebin " TUBEBIN_VERSION);
  add_options(app, arguments);
  try {
    app.parse(argc, argv);
    return run(arguments);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::usage);
  } catch (const ConfigError& error) {
    fmt::print(stderr, "evaluate: {}\n", error.what());
    return static_cast<int>(ExitCode::usage);
  } catch (const std::exception& error) {
    fmt::print(stderr, "evaluate: {}\n", error.what());
    return static_cast<int>(ExitCode::failed);
  }
}
