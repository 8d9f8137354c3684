/// Tunes the parameters of a modelling method on a data set.
#include <fmt/ranges.h>

#include <optional>

#include "program.hpp"
#include "tubebin/calibration/calibration.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/version.hpp"
#include "tubebin/dataset/dataset_config.hpp"
#include "tubebin/jobs/worker_pool.hpp"
#include "tubebin/results/ratios.hpp"

namespace {

using namespace tubebin;

constexpr const char* kExamples = R"(
Examples:
  calibrate_modeler dataset_b --output modeling.yaml
      tunes region_growing on half of the scenes, measures on the other half, and writes what model_tubes --config reads
  calibrate_modeler dataset_b --output modeling.yaml --ratios 0.1,0.3 --budget 100 --jobs 4
      for two downsampling ratios at once, and with more patience
  calibrate_modeler dataset_b --output joining.yaml --config modeling.yaml --parameter greedy_joining.gap_max
                    --parameter greedy_joining.angle_cost=0.0005:0.005:log
      two parameters alone, one over a range of your own; all others stay as the configuration has them

Run the same command again after an interruption, or with a greater --budget: models that were measured already are
taken from the folder modeling.yaml.trials. See docs/calibration.md.
Exit codes: 0 done; 1 input or output failed; 2 wrong usage or configuration; 128 + the signal's number when
interrupted (Ctrl-C: 130).)";

struct Arguments {
  calibration::CalibrationOptions options;
  std::string config;
  std::string method;
  std::string ratios;
  std::vector<std::string> parameters;
  bool quiet = false;
};

void add_options(CLI::App& app, Arguments& arguments) {
  calibration::CalibrationOptions& options = arguments.options;
  options.jobs = jobs::available_cores();
  app.add_option("DATASET", options.dataset, "A data set's folder with ground truth")->required();
  app.add_option("-o,--output", options.output, "The tuned configuration")->type_name("modeling.yaml")->required();
  app.add_option("-c,--config", arguments.config, "Configuration to begin with; without it, the defaults")
      ->type_name("modeling.yaml");
  app.add_option(
         "--method", arguments.method,
         fmt::format("{}; without it, the configuration's, or {}, which has parameters to tune",
                     fmt::join(modeling::method_names(), " or "), name_of(modeling::ModelingMethod::region_growing)))
      ->check(CLI::IsMember(modeling::method_names()));
  app.add_option("--parameter", arguments.parameters,
                 "KEY, KEY=LOW:HIGH or KEY=LOW:HIGH:log to tune; repeatable; without it, the method's own")
      ->allow_extra_args(false)
      ->type_name("KEY=LOW:HIGH");
  app.add_option("--ratios", arguments.ratios, "Downsampling ratios to tune for: 0.1,0.3,1 or first:last:step")
      ->type_name("0.1,0.3");
  app.add_option("--held-back", options.held_back, "Share of the scenes that is measured on and not tuned on")
      ->check(CLI::Range(0.01, 0.99))
      ->capture_default_str();
  app.add_option("--budget", options.budget, "How often all training clouds may be modelled")
      ->check(CLI::Range(1.0, 1e6))
      ->capture_default_str();
  app.add_option("--seed", options.seed, "Of the split and of the search")
      ->check(whole_number())
      ->capture_default_str();
  app.add_option("-j,--jobs", options.jobs, "Worker processes")->check(CLI::Range(1, 1024))->capture_default_str();
  app.add_flag("-q,--quiet", arguments.quiet, "No progress, only errors and results");
}

results::ModelConfig resolve_config(const Arguments& arguments) {
  results::ModelConfig config;
  config.modeling.method = modeling::ModelingMethod::region_growing;
  if (!arguments.config.empty()) config = results::load_model_config(arguments.config);
  if (const auto method = modeling::method_called(arguments.method)) config.modeling.method = *method;
  return config;
}

void print_parameters(const calibration::CalibrationReport& report) {
  fmt::print("{:36} {:>9} {:>9}   {}\n", "parameter", "before", "after", "range");
  for (std::size_t p = 0; p < report.parameters.size(); ++p)
    fmt::print("{:36} {:>9} {:>9}   {} to {}\n", report.parameters[p].key, report.before[p], report.after[p],
               report.parameters[p].range.low, report.parameters[p].range.high);
}

void print_recalls(const char* name, const calibration::BeforeAfter& recalls) {
  std::size_t better = 0, worse = 0;
  for (std::size_t i = 0; i < recalls.before.size(); ++i) {
    better += recalls.after[i] > recalls.before[i] ? 1u : 0u;
    worse += recalls.after[i] < recalls.before[i] ? 1u : 0u;
  }
  fmt::print("{:36} {:9.4f} {:9.4f}   {:+.4f} +- {:.4f} (standard error); {} runs better, {} worse, {} alike\n", name,
             recalls.mean_before(), recalls.mean_after(), recalls.mean_gain(), recalls.gain_error(), better, worse,
             recalls.before.size() - better - worse);
}

int run(Arguments& arguments) {
  calibration::CalibrationOptions& options = arguments.options;
  const results::ModelConfig config = resolve_config(arguments);
  options.ratios =
      arguments.ratios.empty() ? std::vector{config.modeling.filtering.ratio} : results::parse_ratios(arguments.ratios);
  for (const std::string& text : arguments.parameters) options.parameters.push_back(calibration::parse_parameter(text));
  const calibration::CalibrationReport report = calibration::calibrate_modeler(
      options, config, arguments.quiet ? jobs::Progress::Style::none : jobs::Progress::Style::automatic);
  if (report.signal != 0) {
    fmt::print(stderr, "Interrupted after {} models; they are kept. Run the same command again for the rest.\n",
               report.runs_before + report.runs_made);
    return 128 + report.signal;
  }
  print_parameters(report);
  fmt::print("\n{:36} {:>9} {:>9}   gain\n", "mean micro-recall", "before", "after");
  print_recalls(fmt::format("tuned on: {} scenes", report.training_scenes.size()).c_str(), report.training);
  print_recalls(fmt::format("held back: {} scenes", report.held_back_scenes.size()).c_str(), report.held_back);
  fmt::print("\n{}: {} settings tried; {} models made in {:.1f} s, {} there before\n", options.output,
             report.setting_count, report.runs_made, report.seconds, report.runs_before);
  if (report.failed_runs > 0)
    fmt::print(stderr, "{} models crashed or took too long and count as 0; {}.trials/runs.jsonl names them\n",
               report.failed_runs, options.output);
  if (!report.is_recommended())
    fmt::print(
        stderr,
        "Warning: on the scenes that were held back the tuned parameters are worse by {:.4f} +- {:.4f}. {} is not "
        "recommended: keep the configuration that you began with, or tune on more scenes.\n",
        -report.held_back.mean_gain(), report.held_back.gain_error(), options.output);
  return static_cast<int>(ExitCode::done);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app(
      "Tunes the parameters of a modelling method on a data set by micro-recall, and measures them on scenes "
      "that it did not tune on.");
  app.footer(kExamples);
  app.set_version_flag("--version", tool_version());
  add_options(app, arguments);
  return run_program("calibrate_modeler", app, argc, argv, [&] { return run(arguments); });
}
