/// From a configuration to labelled point clouds of settled tubes.
#include "tubebin/dataset/generate_dataset.hpp"

#include <fmt/ranges.h>

#include <cstdlib>
#include <optional>

#include "program.hpp"
#include "tubebin/core/version.hpp"
#include "tubebin/dataset/merge_datasets.hpp"
#include "tubebin/dataset/timing_table.hpp"
#include "tubebin/dataset/verify_dataset.hpp"
#include "tubebin/evaluation/paper_figures.hpp"
#include "tubebin/jobs/shard.hpp"
#include "tubebin/scan/scanner.hpp"

namespace {

using namespace tubebin;

constexpr const char* kExamples = R"(
Examples:
  generate_dataset config/set_a.yaml --output dataset_a
      all scenes of the paper's set A, on all cores
  generate_dataset config/set_b.yaml --output small --tubes 1,5,10-12 --cases 3 --preview
      three scenes each of 1, 5, 10, 11 and 12 tubes, with pictures
  generate_dataset config/set_a.yaml --output emptied --tubes 10 --empty 9
      piles that are taken apart tube by tube: A10/007/step_00 to A10/007/step_09
  generate_dataset config/randomized.yaml --output random --tubes 10 --cases 100
      scenes whose tubes, friction, scanner and noise differ, as networks are trained on (docs/randomization.md)
  generate_dataset config/set_a.yaml --output /shared/dataset_a --shard 2/4
      the second of four shards, which four machines make at once; in a job array of Slurm, AWS Batch or Kubernetes,
      --shard is not needed (docs/scale_out.md)
  generate_dataset config/set_a.yaml --output /shared/dataset_a --shard 2/4 --pack
      the same into one tar, /shared/dataset_a/packs/00002-of-00004.tar, instead of three files a scene
  generate_dataset --merge dataset_a shard_1 shard_2 shard_3 shard_4
      merge the shards that were made into folders of their own; names what is missing and how to make it
  generate_dataset --merge /shared/dataset_a
      the same where the shards were made into one folder
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
  std::optional<int> empty;
  std::optional<std::uint64_t> seed;
  int jobs = jobs::available_cores();
  std::string shard;
  std::optional<int> shard_count;
  bool preview = false;
  bool quiet = false;
  bool pack = false;
  std::vector<std::string> merge;
  std::string verify;
  bool repair = false;

  jobs::Progress::Style progress() const {
    return quiet ? jobs::Progress::Style::none : jobs::Progress::Style::automatic;
  }
};

void add_options(CLI::App& app, Arguments& arguments) {
  auto* config = app.add_option("CONFIG", arguments.config, "Configuration file (YAML, see docs/configuration.md)");
  auto* output = app.add_option("-o,--output", arguments.output, "Folder of the data set")->type_name("DIR");
  app.add_option("--tubes", arguments.tubes, "Numbers of tubes, instead of the configuration's")
      ->type_name("1,5,10-15");
  app.add_option("--cases", arguments.cases, "Scenes for each number of tubes, instead of the configuration's")
      ->check(CLI::Range(1, 1000000));
  app.add_option("--empty", arguments.empty, "Tubes to lift out of each pile, a scene after each (sequence.lifts)")
      ->check(CLI::Range(1, 10000));
  app.add_option("--seed", arguments.seed, "Seed, instead of the configuration's")->check(whole_number());
  app.add_option("-j,--jobs", arguments.jobs, "Worker processes")->check(CLI::Range(1, 1024))->capture_default_str();
  app.add_option("--shard", arguments.shard,
                 "Make only shard I of N, counted from 1; without it, as the environment of a job array says")
      ->type_name("I/N");
  app.add_option("--shard-count", arguments.shard_count, "N, where a scheduler says I alone (Kubernetes)")
      ->check(CLI::Range(1, 1000000))
      ->envname("TUBEBIN_SHARD_COUNT");
  app.add_flag("--preview", arguments.preview, "Also render pictures of each scene");
  app.add_flag("--pack", arguments.pack, "Into one tar a shard, in WebDataset's layout, instead of a folder a scene");
  app.add_flag_callback(
      "--config-reference",
      [] {
        fmt::print("{}", dataset::document_config());
        throw CLI::Success();
      },
      "Print every key of a configuration as Markdown, and exit");
  app.add_flag("-q,--quiet", arguments.quiet, "No progress, only errors and the final table");
  auto* verify =
      app.add_option("--verify", arguments.verify, "Check a data set instead of making one")->type_name("DIR");
  app.add_flag("--repair", arguments.repair, "Make damaged scenes anew")->needs(verify);
  auto* merge = app.add_option("--merge", arguments.merge,
                               "Merge shards into the folder OUT, or complete OUT where they were made into it")
                    ->type_name("OUT DIR...")
                    ->expected(1, -1);
  verify->excludes(config)->excludes(output);
  merge->excludes(config)->excludes(output)->excludes(verify);
}

/// For checks of values that no place in a file can be named for.
KeyPlaces whole_file(const std::string& name) {
  KeyPlaces places;
  places.set("", name);
  return places;
}

dataset::DatasetConfig resolve_config(const Arguments& arguments) {
  if (arguments.config.empty() || arguments.output.empty())
    throw_usage_error("CONFIG.yaml and --output DIR are needed");
  dataset::DatasetConfig config = dataset::load_config(arguments.config);
  if (!arguments.tubes.empty()) config.tubes = dataset::parse_tube_counts(arguments.tubes);
  if (arguments.cases) config.cases = *arguments.cases;
  if (arguments.empty) config.sequence.lifts = *arguments.empty;
  if (arguments.seed) config.seed = *arguments.seed;
  if (arguments.preview) config.output.preview = true;
  check(config, whole_file("command line"));
  return config;
}

void print_summary(const dataset::GenerationReport& report, std::size_t scene_count) {
  std::string rejects = fmt::format("{} attempts were rejected", report.rejects_total());
  std::vector<std::string> reasons;
  for (const auto& [reason, count] : report.rejects) reasons.push_back(fmt::format("{} {}", count, reason));
  if (!reasons.empty()) rejects += fmt::format(" ({})", fmt::join(reasons, ", "));
  fmt::print(stderr, "{} of {} scenes are complete: {} made in {:.1f} s, {} were there before. {}.\n",
             report.complete_before + report.made, scene_count, report.made, report.seconds, report.complete_before,
             rejects);
}

/// Table 1 of the paper, for its sets A and B.
dataset::SecondsByTubes paper_seconds(const std::string& set) {
  const auto& by_set = evaluation::paper_figures().generation_seconds;
  const auto seconds = by_set.find(set);
  return seconds == by_set.end() ? dataset::SecondsByTubes{} : seconds->second;
}

/// Makes the scenes and says how it went.
int make_scenes(dataset::DatasetFolder& folder, const std::vector<dataset::SceneId>& scenes, const jobs::Shard& shard,
                const Arguments& arguments) {
  const std::string pack = arguments.pack ? shard.name() : "";
  const dataset::GenerationReport report =
      dataset::generate_dataset(folder, scenes, arguments.jobs, arguments.progress(), pack);
  if (!arguments.quiet) print_summary(report, scenes.size());
  for (const std::string& failed : report.failed) fmt::print(stderr, "{}\n", failed);
  if (report.signal != 0) {
    fmt::print(stderr, "Interrupted after {} of {} scenes; they are kept. Run the same command again for the rest.\n",
               report.complete_before + report.made, scenes.size());
    return 128 + report.signal;
  }
  // The paper's scenes are a drop each.
  const bool is_emptied = folder.config().sequence.lifts > 0;
  fmt::print("{}",
             dataset::format_timing_table(folder.manifest(), scenes,
                                          is_emptied ? dataset::SecondsByTubes{} : paper_seconds(folder.config().set)));
  return static_cast<int>(report.failed.empty() ? ExitCode::done : ExitCode::incomplete);
}

std::int64_t cost_of(const std::vector<dataset::SceneId>& scenes) {
  std::int64_t cost = 0;
  for (const dataset::SceneId& id : scenes) cost += jobs::generation_cost(id.tubes);
  return cost;
}

void print_shard(const jobs::ShardChoice& choice, const std::vector<dataset::SceneId>& scenes,
                 const dataset::DatasetConfig& config) {
  const std::vector<dataset::SceneId> all = dataset::list_scenes(config);
  fmt::print(stderr, "Shard {} of {} ({}): {} of {} scenes, {:.1f} % of the work\n", choice.shard.index,
             choice.shard.count, choice.source, scenes.size(), all.size(),
             100.0 * static_cast<double>(cost_of(scenes)) / static_cast<double>(cost_of(all)));
}

int generate(const Arguments& arguments) {
  const jobs::ShardChoice choice = jobs::choose_shard(arguments.shard, arguments.shard_count, std::getenv);
  const dataset::DatasetConfig config = resolve_config(arguments);
  const std::vector<dataset::SceneId> scenes = dataset::list_scenes(config, choice.shard);
  if (!choice.is_sharded()) {
    dataset::DatasetFolder folder(arguments.output, config);
    return make_scenes(folder, scenes, {}, arguments);
  }
  if (!arguments.quiet) print_shard(choice, scenes, config);
  dataset::DatasetFolder folder(
      arguments.output, config, choice.shard,
      arguments.pack ? dataset::DatasetFolder::ShardScenes::packed : dataset::DatasetFolder::ShardScenes::loose);
  return make_scenes(folder, scenes, choice.shard, arguments);
}

int repair(const dataset::VerificationReport& report, const Arguments& arguments) {
  const dataset::DatasetConfig config = dataset::read_dataset_config(arguments.verify);
  check(config, whole_file(arguments.verify + "/config.yaml"));
  dataset::DatasetFolder folder(arguments.verify, config);
  dataset::forget_damage(folder, report);
  return make_scenes(folder, report.damaged, {}, arguments);
}

int verify(const Arguments& arguments) {
  const dataset::VerificationReport report =
      dataset::verify_dataset(arguments.verify, arguments.jobs, arguments.progress());
  for (const std::string& problem : report.problems) fmt::print("{}\n", problem);
  fmt::print("{}: {} scenes checked, {} damaged, {} not generated yet\n", arguments.verify, report.checked,
             report.damaged.size(), report.missing);
  std::fflush(stdout);
  if (report.signal != 0) return 128 + report.signal;
  if (report.sound()) return static_cast<int>(ExitCode::done);
  return arguments.repair ? repair(report, arguments) : static_cast<int>(ExitCode::incomplete);
}

/// Names the first few one by one.
void print_names(const std::vector<std::string>& names) {
  constexpr std::size_t shown = 20;
  for (std::size_t i = 0; i < std::min(names.size(), shown); ++i) fmt::print("  {}\n", names[i]);
  if (names.size() > shown) fmt::print("  and {} more\n", names.size() - shown);
}

int merge(const Arguments& arguments) {
  const std::string& output = arguments.merge.front();
  const dataset::MergeReport report = dataset::merge_datasets(
      output, {arguments.merge.begin() + 1, arguments.merge.end()}, arguments.jobs, arguments.progress());
  if (report.signal != 0) {
    fmt::print(stderr, "Interrupted; what is joined is kept. Run the same command again for the rest.\n");
    return 128 + report.signal;
  }
  for (const std::string& problem : report.problems) fmt::print("{}\n", problem);
  fmt::print("{}: {} of {} scenes are complete and sound, {} are missing, {} could not be checked\n", output,
             report.complete, report.scenes, report.missing.size(), report.unchecked.size());
  print_names(report.missing);
  for (const std::string& command : report.commands) fmt::print("To make exactly what is missing:\n  {}\n", command);
  return static_cast<int>(report.is_whole() ? ExitCode::done : ExitCode::incomplete);
}

int run(const Arguments& arguments) {
  if (!arguments.merge.empty()) return merge(arguments);
  return arguments.verify.empty() ? generate(arguments) : verify(arguments);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Generates data sets of entangled tubes in a bin: labelled point clouds with their ground truth.");
  app.footer(kExamples);
  app.set_version_flag("--version", fmt::format("{} (Embree {})", tool_version(), scan::embree_version()));
  add_options(app, arguments);
  return run_program("generate_dataset", app, argc, argv, [&] { return run(arguments); });
}
