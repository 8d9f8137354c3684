/// From a configuration to labelled point clouds of settled tubes.
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <optional>

#include "tubebin/dataset/generate_dataset.hpp"
#include "tubebin/dataset/timing_table.hpp"

namespace {

using namespace tubebin;

constexpr const char* kExamples = R"(
Examples:
  generate_dataset config/set_a.yaml --output dataset_a
      all scenes of the paper's set A, on all cores
  generate_dataset config/set_b.yaml --output small --tubes 1,5,10-12 --cases 3 --preview
      three scenes each of 1, 5, 10, 11 and 12 tubes, with pictures
  generate_dataset config/set_a.yaml --output part_2 --shard 2/4
      the second of four parts, which four machines make

Run the same command again after an interruption: complete scenes are kept.
Exit codes: 0 done; 1 input or output failed; 2 wrong usage or configuration; 3 finished, but some scenes could not
be done (each is named); 130 and 143 interrupted by Ctrl-C or SIGTERM.)";

struct Arguments {
  std::string config;
  std::string output;
  std::string tubes;
  std::optional<int> cases;
  std::optional<std::uint64_t> seed;
  int jobs = available_cores();
  std::string shard = "1/1";
  bool preview = false;
  bool quiet = false;

  Progress::Style progress() const { return quiet ? Progress::Style::none : Progress::Style::automatic; }
};

void add_options(CLI::App& app, Arguments& arguments) {
  app.add_option("CONFIG", arguments.config, "Configuration file (YAML, see docs/configuration.md)");
  app.add_option("-o,--output", arguments.output, "Folder of the data set")->type_name("DIR");
  app.add_option("--tubes", arguments.tubes, "Numbers of tubes, instead of the configuration's")->type_name("1,5,10-15");
  app.add_option("--cases", arguments.cases, "Scenes for each number of tubes, instead of the configuration's")
      ->check(CLI::Range(1, 1000000));
  app.add_option("--seed", arguments.seed, "Seed, instead of the configuration's");
  app.add_option("-j,--jobs", arguments.jobs, "Worker processes")->check(CLI::Range(1, 1024))->capture_default_str();
  app.add_option("--shard", arguments.shard, "Make only part I of N, counted from 1")->type_name("I/N");
  app.add_flag("--preview", arguments.preview, "Also render pictures of each scene");
  app.add_flag_callback(
      "--config-reference",
      [] {
        fmt::print("{}", document_config());
        throw CLI::Success();
      },
      "Print every key of a configuration as Markdown, and exit");
  app.add_flag("-q,--quiet", arguments.quiet, "No progress, only errors and the final table");
}

DatasetConfig resolve_config(const Arguments& arguments) {
  if (arguments.config.empty() || arguments.output.empty())
    throw_config_error("CONFIG.yaml and --output DIR are needed; --help shows examples");
  DatasetConfig config = load_config(arguments.config);
  if (!arguments.tubes.empty()) config.tubes = parse_tube_counts(arguments.tubes);
  if (arguments.cases) config.cases = *arguments.cases;
  if (arguments.seed) config.seed = *arguments.seed;
  if (arguments.preview) config.output.preview = true;
  check(config, {});
  return config;
}

void print_summary(const GenerationReport& report, std::size_t scene_count) {
  std::string rejects = fmt::format("{} attempts were rejected", report.rejects_total());
  std::vector<std::string> reasons;
  for (const auto& [reason, count] : report.rejects) reasons.push_back(fmt::format("{} {}", count, reason));
  if (!reasons.empty()) rejects += fmt::format(" ({})", fmt::join(reasons, ", "));
  fmt::print(stderr, "{} of {} scenes are complete: {} made in {:.1f} s, {} were there before. {}.\n",
             report.complete_before + report.made, scene_count, report.made, report.seconds, report.complete_before,
             rejects);
}

int generate(const Arguments& arguments) {
  const Shard shard = parse_shard(arguments.shard);
  const DatasetConfig config = resolve_config(arguments);
  DatasetFolder folder(arguments.output, config);
  const std::vector<SceneId> scenes = list_scenes(config, shard);
  const GenerationReport report = generate_dataset(folder, scenes, arguments.jobs, arguments.progress());

  if (!arguments.quiet) print_summary(report, scenes.size());
  for (const std::string& failed : report.failed) fmt::print(stderr, "{}\n", failed);
  if (report.signal != 0) {
    fmt::print(stderr, "Interrupted after {} of {} scenes; they are kept. Run the same command again for the rest.\n",
               report.complete_before + report.made, scenes.size());
    return 128 + report.signal;
  }
  fmt::print("{}", format_timing_table(folder.manifest(), scenes));
  return static_cast<int>(report.failed.empty() ? ExitCode::done : ExitCode::incomplete);
}

int run(const Arguments& arguments) { return generate(arguments); }

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Generates data sets of entangled tubes in a bin: labelled point clouds with their ground truth.");
  app.footer(kExamples);
  app.set_version_flag("--version", tool_version());
  add_options(app, arguments);
  try {
    app.parse(argc, argv);
    return run(arguments);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::usage);
  } catch (const ConfigError& error) {
    fmt::print(stderr, "generate_dataset: {}\n", error.what());
    return static_cast<int>(ExitCode::usage);
  } catch (const std::exception& error) {
    fmt::print(stderr, "generate_dataset: {}\n", error.what());
    return static_cast<int>(ExitCode::failed);
  }
}
