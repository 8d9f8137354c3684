/// Tubes from point clouds: one cloud, or every cloud of a data set.
#include <fmt/ranges.h>
#include <tbb/global_control.h>

#include <cstdlib>
#include <filesystem>
#include <optional>

#include "program.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/memory.hpp"
#include "tubebin/core/path_status.hpp"
#include "tubebin/core/version.hpp"
#include "tubebin/dataset/dataset_config.hpp"
#include "tubebin/jobs/worker_pool.hpp"
#include "tubebin/modeling/model_json.hpp"
#include "tubebin/results/ratios.hpp"
#include "tubebin/results/resume_batch.hpp"

namespace {

using namespace tubebin;
namespace fs = std::filesystem;

constexpr const char* kExamples = R"(
Examples:
  model_tubes dataset_a/A10/007/cloud.pcd --output model
      the tubes of one cloud: model/filtered.pcd, model/labeled.pcd, model/model.json
  model_tubes scan.ply --scale 0.001 --output model
      a scanner's file in millimetres; whatever stands around the tubes is found in the cloud (docs/your_own_scanner.md)
  model_tubes scan.ply --radius 0.008,0.016 --output model
      tubes of two known radii
  model_tubes scan.ply --tube-shape 0.07,90,0.1,90,0.07 --output model
      parts of one kind, bent twice at right angles to a U, also where few of them are seen whole
  model_tubes dataset_a --output results --ratios 0.1:1.0:0.1 --jobs 4
      every cloud of a data set at ten ratios, for evaluate (see docs/results_format.md)
  model_tubes dataset_a --output results --method region_growing --ratios 0.3
      the paper's method, into the same results
  model_tubes /shared/dataset_a --output /shared/results --shard 2/4
      the second of four shards, which four machines do at once; in a job array of Slurm, AWS Batch or Kubernetes,
      --shard is not needed (docs/scale_out.md)

Run the same command again after an interruption: complete results are kept.
Exit codes: 0 done; 1 input or output failed; 2 wrong usage or configuration; 3 finished, but some clouds could not be
done (each is named), or the result may not be trusted (a warning says why); 130 and 143 interrupted by Ctrl-C or SIGTERM.)";

struct Arguments {
  std::string input;
  std::string output;
  std::vector<std::string> resume;
  std::string config;
  std::string method;
  std::optional<double> ratio;
  std::string ratios;
  std::vector<double> radii;
  std::optional<double> tube_length;
  std::vector<std::string> tube_shapes;
  double bend_radius = 0.0;
  std::optional<std::uint64_t> seed;
  double scale = 1.0;
  int jobs = jobs::available_cores();
  int cases = 0;
  std::string shard;
  std::optional<int> shard_count;
  std::vector<double> bin_pose, viewpoint, up, crop;
  bool full = false;
  bool keep_clouds = false;
  bool quiet = false;
};

void add_options(CLI::App& app, Arguments& arguments) {
  auto* input = app.add_option("CLOUD_OR_DATASET", arguments.input,
                               "A .pcd or .ply file, or a data set: its folder, or a .tar that --pack made");
  auto* output = app.add_option("-o,--output", arguments.output, "Folder of the results")->type_name("DIR");
  app.add_option("-c,--config", arguments.config, "Options (YAML, see docs/modeling.md)")->type_name("modeling.yaml");
  std::vector<std::string> methods = modeling::method_names();
  methods.emplace_back("both");
  app.add_option("--method", arguments.method,
                 fmt::format("{}, or both (data sets only)", fmt::join(modeling::method_names(), ", ")))
      ->check(CLI::IsMember(methods));
  app.add_option("--ratio", arguments.ratio, "Part of the points to keep, above 0 and up to 1");
  app.add_option("--ratios", arguments.ratios, "Ratios for a data set: 0.1,0.3,1 or first:last:step")
      ->type_name("0.1:1.0:0.1");
  app.add_option("--radius", arguments.radii,
                 "Radius of the tubes in metres, or several: 0.008,0.016; without it, estimated")
      ->delimiter(',')
      ->type_name("R[,R...]");
  app.add_option("--tube-length", arguments.tube_length, "Length of every tube in metres; without it, estimated");
  auto* shape =
      app.add_option("--tube-shape", arguments.tube_shapes,
                     "Shape of the parts: straight stretches in metres and the bends between them in degrees, "
                     "BEND@ROTATION where a bend's plane is rotated; once for each kind of part")
          ->allow_extra_args(false)
          ->type_name("L,BEND,L[,BEND,L...]");
  app.add_option("--bend-radius", arguments.bend_radius,
                 "Radius of the centreline in the bends of --tube-shape, metres; without it, corners")
      ->needs(shape)
      ->type_name("R");
  app.add_option(
         "--bin-pose", arguments.bin_pose,
         "Where the configuration's bin stands, about: the middle of its inner floor in metres, and roll, pitch, "
         "yaw in degrees; the cloud refines it")
      ->delimiter(',')
      ->expected(6)
      ->type_name("X,Y,Z,ROLL,PITCH,YAW");
  app.add_option(
         "--viewpoint", arguments.viewpoint,
         "Where the scanner stood, metres; of a merged cloud once for each source, from 0; without it, as the file "
         "says, or scene.json")
      ->delimiter(',')
      ->type_size(3)
      ->allow_extra_args(false)
      ->type_name("X,Y,Z");
  app.add_option("--up", arguments.up, "Against gravity, in the cloud's frame; without it, found")
      ->delimiter(',')
      ->expected(3)
      ->type_name("X,Y,Z");
  app.add_option("--crop", arguments.crop, "Two corners of the box that tubes are looked for in, metres")
      ->delimiter(',')
      ->expected(6)
      ->type_name("X,Y,Z,X,Y,Z");
  app.add_flag("--full", arguments.full,
               "Also write full.pcd, all points in their places, labelled; always for an organized cloud");
  app.add_option("--scale", arguments.scale, "Factor from the file's unit to metres: 0.001 for millimetres")
      ->check(positive_number("a number above 0, like 0.001 for a file in millimetres"));
  app.add_option("--seed", arguments.seed, "Seed of downsampling and RANSAC")->check(whole_number());
  app.add_option("-j,--jobs", arguments.jobs, "Worker processes for a data set, cores for one cloud")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_option("--cases", arguments.cases, "Only the first cases of each set and number of tubes")
      ->check(CLI::Range(1, 1000000));
  app.add_option(
         "--shard", arguments.shard,
         "Do only shard I of N of a data set, counted from 1; without it, as the environment of a job array says")
      ->type_name("I/N");
  app.add_option("--shard-count", arguments.shard_count, "N, where a scheduler says I alone (Kubernetes)")
      ->check(CLI::Range(1, 1000000))
      ->envname("TUBEBIN_SHARD_COUNT");
  app.add_option(
         "--resume", arguments.resume,
         "Do the runs that results folders lack, by their own options: one folder, or those of a call's shards, "
         "into the first")
      ->type_name("RESULTS...")
      ->excludes(input)
      ->excludes(output);
  app.add_flag("--keep-clouds", arguments.keep_clouds, "Also write filtered.pcd and labeled.pcd of a data set's runs");
  app.add_flag_callback(
      "--config-reference",
      [] {
        results::ModelConfig defaults;
        fmt::print("{}", document_fields([&](Fields& fields) { describe(fields, defaults); }));
        throw CLI::Success();
      },
      "Print every key of a configuration as Markdown, and exit");
  app.add_flag("-q,--quiet", arguments.quiet, "No progress, only errors and results");
}

/// Numbers from the command line pass the same checks as the configuration's.
results::ModelConfig resolve_config(const Arguments& arguments) {
  results::ModelConfig config =
      arguments.config.empty() ? results::ModelConfig{} : results::load_model_config(arguments.config);
  std::string text;
  const auto set = [&](const char* key, const auto& value) {
    if (value) text += fmt::format("{}: {}\n", key, *value);
  };
  if (!arguments.radii.empty()) {
    config.modeling.other_radii.clear();
    text += fmt::format("radius: {}\n", arguments.radii.front());
    for (std::size_t k = 1; k < arguments.radii.size(); ++k)
      text += fmt::format("{}  - radius: {}\n", k == 1 ? "other_radii:\n" : "", arguments.radii[k]);
  }
  const auto set_vector = [&](const char* key, const std::vector<double>& numbers, std::size_t first) {
    if (!numbers.empty())
      text += fmt::format("{}: [{}, {}, {}]\n", key, numbers[first], numbers[first + 1], numbers[first + 2]);
  };
  set_vector("viewpoint", arguments.viewpoint, 0);
  set_vector("up", arguments.up, 0);
  set_vector("crop_min", arguments.crop, 0);
  set_vector("crop_max", arguments.crop, 3);
  set_vector("bin_position", arguments.bin_pose, 0);
  set_vector("bin_rotation_deg", arguments.bin_pose, 3);
  if (!arguments.bin_pose.empty()) text += "bin_source: config\n";
  set("tube_length", arguments.tube_length);
  std::vector<modeling::TubeShape> shapes;
  for (const std::string& told : arguments.tube_shapes) {
    shapes.push_back(modeling::parse_tube_shape(told));
    shapes.back().bend_radius = arguments.bend_radius;
  }
  if (!shapes.empty()) text += write_yaml([&](Fields& fields) { fields.list("tube_shapes", shapes, ""); });
  set("seed", arguments.seed);
  if (!arguments.method.empty() && arguments.method != "both") text += "method: " + arguments.method + "\n";
  if (arguments.ratio) text += fmt::format("filtering: {{ratio: {}}}\n", *arguments.ratio);
  if (!text.empty())
    check(config.modeling, read_yaml_text(text, "command line", [&](Fields& fields) { describe(fields, config); }));
  return config;
}

/// Of several sources; a single viewpoint is the configuration's.
void tell_viewpoints(results::CloudToModel& input, const Arguments& arguments) {
  const auto& numbers = arguments.viewpoint;
  for (std::size_t k = 3; k < numbers.size(); k += 3) {
    if (k == 3) input.cloud.world_from_sensor.translation() = Vec3(numbers[0], numbers[1], numbers[2]);
    input.world_from_further_sensors.emplace_back(Eigen::Translation3d(numbers[k], numbers[k + 1], numbers[k + 2]));
  }
}

int model_one(const Arguments& arguments) {
  if (!arguments.ratios.empty() || arguments.method == "both" || arguments.keep_clouds || arguments.cases > 0 ||
      !arguments.shard.empty())
    throw_config_error("{} is a file: --ratios, --method both, --cases, --shard and --keep-clouds are for data sets",
                       arguments.input);
  keep_memory();
  const tbb::global_control cores(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(arguments.jobs));
  results::ModelConfig config = resolve_config(arguments);
  results::CloudToModel input = results::read_cloud_to_model(arguments.input, arguments.scale);
  tell_viewpoints(input, arguments);
  config.modeling.label_all = arguments.full || input.cloud.organized();
  const modeling::ModelingResult result = results::model_cloud(input, config);
  std::error_code error;
  fs::create_directories(arguments.output, error);
  if (error) throw_io_error("{}: cannot be made: {}", arguments.output, error.message());
  cloud::write_cloud(arguments.output + "/filtered.pcd", results::filtered_cloud(input.cloud, result),
                     cloud::CloudFormat::pcd_binary);
  cloud::write_cloud(arguments.output + "/labeled.pcd", results::labeled_cloud(input.cloud, result),
                     cloud::CloudFormat::pcd_binary);
  if (config.modeling.label_all)
    cloud::write_cloud(arguments.output + "/full.pcd", results::fully_labeled_cloud(input.cloud, result),
                       cloud::CloudFormat::pcd_binary);
  write_file_atomically(arguments.output + "/model.json", modeling::format_model_json(
                                                              result, results::model_colors(result),
                                                              [&](Fields& fields) { describe(fields, config); }, true));

  const auto unlabeled = std::count(result.labels.begin(), result.labels.end(), cloud::Label{0});
  fmt::print("{} tubes of radius {:.2f} mm in {} points, {} of them without a tube; {:.1f} ms\n", result.tubes.size(),
             result.radius * 1e3, result.labels.size(), unlabeled, result.seconds.total() * 1e3);
  for (std::size_t k = 0; k < result.tubes.size(); ++k) {
    const modeling::TubeModel& tube = result.tubes[k];
    const auto points = std::ranges::count(result.labels, static_cast<cloud::Label>(k + 1));
    if (tube.is_ball())
      fmt::print("tube {}: a ball of radius {:.2f} mm, {} points\n", k + 1, tube.radius * 1e3, points);
    else
      fmt::print("tube {}: {} cylinders, {:.3f} m, {} points\n", k + 1, tube.cylinder_count(), tube.length(), points);
  }
  fmt::print("{}\n", modeling::describe_found(result));
  for (const std::string& doubt : result.found.doubts) fmt::print(stderr, "Warning: {}: {}\n", arguments.input, doubt);
  return static_cast<int>(result.found.doubts.empty() ? ExitCode::done : ExitCode::incomplete);
}

/// A folder, or a pack of scenes.
bool is_dataset(const std::string& path) { return is_folder(path) || fs::path(path).extension() == ".tar"; }

results::BatchOptions batch_options(const Arguments& arguments, const results::ModelConfig& config) {
  if (arguments.viewpoint.size() > 3)
    throw_config_error("--viewpoint once for each source is for single files; scene.json has a data set's");
  if (arguments.scale != 1.0) throw_config_error("--scale is for single files; data sets are in metres");
  if (arguments.full) throw_config_error("--full is for single files; --keep-clouds writes a data set's clouds");
  if (arguments.ratio && !arguments.ratios.empty()) throw_config_error("--ratio and --ratios say the same: give one");
  results::BatchOptions options;
  options.dataset = arguments.input;
  options.results = arguments.output;
  options.methods = {config.modeling.method};
  options.ratios = {config.modeling.filtering.ratio};
  options.cases = arguments.cases;
  if (arguments.method == "both") {
    if (!config.modeling.tube_shapes.empty()) throw_config_error("tube_shapes is for method centerline, not for both");
    options.methods = modeling::all_methods();
  }
  if (!arguments.ratios.empty()) options.ratios = results::parse_ratios(arguments.ratios);
  return options;
}

void choose_shard_of_clouds(results::BatchOptions& options, const Arguments& arguments) {
  const jobs::ShardChoice choice = jobs::choose_shard(arguments.shard, arguments.shard_count, std::getenv);
  if (!choice.is_sharded()) return;
  options.shard = choice.shard;
  if (arguments.quiet) return;
  options.on_shard = [choice](std::size_t own, std::size_t all, double share) {
    fmt::print(stderr, "Shard {} of {} ({}): {} of {} clouds, {:.1f} % of the work\n", choice.shard.index,
               choice.shard.count, choice.source, own, all, 100.0 * share);
  };
}

int model_many(results::BatchOptions options, const results::ModelConfig& config, const Arguments& arguments) {
  options.jobs = arguments.jobs;
  options.keep_clouds = arguments.keep_clouds;
  choose_shard_of_clouds(options, arguments);
  const results::BatchReport report = results::model_dataset(
      options, config, arguments.quiet ? jobs::Progress::Style::none : jobs::Progress::Style::automatic);
  for (const std::string& failed : report.failed) fmt::print(stderr, "{}\n", failed);
  if (report.signal != 0)
    fmt::print(stderr, "Interrupted after {} of {} runs; they are kept. Run the same command again for the rest.\n",
               report.complete_before + report.made, report.runs);
  else
    fmt::print("{}: {} runs, {} made in {:.1f} s, {} there before, {} failed\n", options.results, report.runs,
               report.made, report.seconds, report.complete_before, report.failed.size());
  if (report.signal != 0) return 128 + report.signal;
  return static_cast<int>(report.failed.empty() ? ExitCode::done : ExitCode::incomplete);
}

/// Everything but what to do it with is as the first call said.
int resume(const Arguments& arguments) {
  if (!arguments.config.empty() || !arguments.method.empty() || arguments.ratio || !arguments.ratios.empty() ||
      !arguments.radii.empty() || arguments.tube_length || !arguments.tube_shapes.empty() || arguments.seed ||
      !arguments.bin_pose.empty() || !arguments.viewpoint.empty() || !arguments.up.empty() || !arguments.crop.empty() ||
      arguments.scale != 1.0 || arguments.full || arguments.cases > 0)
    throw_config_error("--resume takes the options of the modeller from {}/index.json", arguments.resume.front());
  const results::ResumedBatch batch = results::resume_batch(arguments.resume);
  return model_many(batch.options, batch.config, arguments);
}

int run(const Arguments& arguments) {
  if (!arguments.resume.empty()) return resume(arguments);
  if (arguments.input.empty() || arguments.output.empty())
    throw_usage_error("CLOUD_OR_DATASET and --output DIR are needed");
  if (!is_dataset(arguments.input)) return model_one(arguments);
  const results::ModelConfig config = resolve_config(arguments);
  return model_many(batch_options(arguments, config), config, arguments);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Models tubes from point clouds: which tube each point belongs to, and the cylinders of each.");
  app.footer(kExamples);
  app.set_version_flag("--version", tool_version());
  add_options(app, arguments);
  return run_program("model_tubes", app, argc, argv, [&] { return run(arguments); });
}
