/// From a configuration to labelled point clouds of settled tubes.
#include "tubebin/dataset/generate_dataset.hpp"

#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <optional>

#include "tubebin/dataset/timing_table.hpp"
#include "tubebin/dataset/verify_dataset.hpp"
#include "tubebin/scan/scanner.hpp"

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
  generate_dataset --verify dataset_a
      check every scene of a data set; with --repair, make damaged ones anew

Run the same command again after an interruption: complete scenes are kept.
Exit codes: 0 done; 1 input or output failed; 2 wrong usage or configuration; 3 finished, but some scenes could not
be done or are damaged (each is named); 128 + the signal's number when interrupted (Ctrl-C: 130).)";

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
  std::string verify;
  bool repair = false;

  Progress::Style progress() const { return quiet ? Progress::Style::none : Progress::Style::automatic; }
};

void add_options(CLI::App& app, Arguments& arguments) {
  auto* config = app.add_option("CONFIG", arguments.config, "Configuration file (YAML, see docs/configuration.md)");
  auto* output = app.add_option("-o,--output", arguments.output, "Folder of the data set")->type_name("DIR");
  app.add_option("--tubes", arguments.tubes, "Numbers of tubes, instead of the configuration's")
      ->type_name("1,5,10-15");
  app.add_option("--cases", arguments.cases, "Scenes for each number of tubes, instead of the configuration's")
      ->check(CLI::Range(1, 1000000));
  app.add_option("--seed", arguments.seed, "Seed, instead of the configuration's")->check(CLI::NonNegativeNumber);
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
  auto* verify =
      app.add_option("--verify", arguments.verify, "Check a data set instead of making one")->type_name("DIR");
  app.add_flag("--repair", arguments.repair, "Make damaged scenes anew")->needs(verify);
  verify->excludes(config)->excludes(output);
}

/// For checks of values that no place in a file can be named for.
KeyPlaces whole_file(const std::string& name) {
  KeyPlaces places;
  places.set("", name);
  return places;
}

DatasetConfig resolve_config(const Arguments& arguments) {
  if (arguments.config.empty() || arguments.output.empty())
    throw_config_error("CONFIG.yaml and --output DIR are needed; --help shows examples");
  DatasetConfig config = load_config(arguments.config);
  if (!arguments.tubes.empty()) config.tubes = parse_tube_counts(arguments.tubes);
  if (arguments.cases) config.cases = *arguments.cases;
  if (arguments.seed) config.seed = *arguments.seed;
  if (arguments.preview) config.output.preview = true;
  check(config, whole_file("command line"));
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

/// Makes the scenes and says how it went.
int make_scenes(DatasetFolder& folder, const std::vector<SceneId>& scenes, const Arguments& arguments) {
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

int generate(const Arguments& arguments) {
  const Shard shard = parse_shard(arguments.shard);
  const DatasetConfig config = resolve_config(arguments);
  DatasetFolder folder(arguments.output, config);
  return make_scenes(folder, list_scenes(config, shard), arguments);
}

int repair(const VerificationReport& report, const Arguments& arguments) {
  const DatasetConfig config = read_dataset_config(arguments.verify);
  check(config, whole_file(arguments.verify + "/config.yaml"));
  DatasetFolder folder(arguments.verify, config);
  forget_damage(folder, report);
  return make_scenes(folder, report.damaged, arguments);
}

int verify(const Arguments& arguments) {
  const VerificationReport report = verify_dataset(arguments.verify, arguments.jobs, arguments.progress());
  for (const std::string& problem : report.problems) fmt::print("{}\n", problem);
  fmt::print("{}: {} scenes checked, {} damaged, {} not generated yet\n", arguments.verify, report.checked,
             report.damaged.size(), report.missing);
  std::fflush(stdout);
  if (report.signal != 0) return 128 + report.signal;
  if (report.sound()) return static_cast<int>(ExitCode::done);
  return arguments.repair ? repair(report, arguments) : static_cast<int>(ExitCode::incomplete);
}

int run(const Arguments& arguments) { return arguments.verify.empty() ? generate(arguments) : verify(arguments); }

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Generates data sets of entangled tubes in a bin: labelled point clouds with their ground truth.");
  app.footer(kExamples);
  app.set_version_flag("--version", fmt::format("{} (Embree {})", tool_version(), embree_version()));
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
