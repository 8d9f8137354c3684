/// A data set in the formats that other tools read.
#include "tubebin/export/export_dataset.hpp"

#include <fmt/ranges.h>

#include "program.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/version.hpp"
#include "tubebin/dataset/dataset_config.hpp"
#include "tubebin/jobs/worker_pool.hpp"

namespace {

using namespace tubebin;

constexpr const char* kExamples = R"(
Formats (docs/export_formats.md):
  bop    6D pose estimation: depth, shaded images, whole and visible masks, poses, a mesh for each object; millimetres
  coco   instance segmentation: shaded images and one annotations.json with visible and amodal masks
  npz    arrays for numpy, PyTorch and JAX, one file a scene
  ply    clouds of the tubes alone and tubes as text, in the published data set's folders
  sdf    Gazebo worlds of the settled scenes

Examples:
  export_dataset dataset_a --format bop --output dataset_a_bop
  export_dataset dataset_a --format coco --crop --output dataset_a_coco
  export_dataset data --format npz --output arrays --jobs 1

Run the same command again after an interruption, or when the data set has grown: complete scenes are kept.
Exit codes: 0 done; 1 input or output failed; 2 wrong usage; 3 finished, but some scenes could not be exported (each is
named); 130 and 143 interrupted by Ctrl-C or SIGTERM.)";

int run(const exports::ExportOptions& options, bool quiet) {
  const exports::ExportReport report =
      exports::export_dataset(options, quiet ? jobs::Progress::Style::none : jobs::Progress::Style::automatic);
  for (const std::string& failed : report.failed) fmt::print(stderr, "{}\n", failed);
  if (report.signal != 0) {
    fmt::print(stderr, "Interrupted after {} of {} scenes; they are kept. Run the same command again for the rest.\n",
               report.complete_before + report.made, report.scenes);
    return 128 + report.signal;
  }
  fmt::print("{}: {} scenes, {} exported in {:.1f} s, {} there before, {} failed\n", options.output, report.scenes,
             report.made, report.seconds, report.complete_before, report.failed.size());
  return static_cast<int>(report.failed.empty() ? ExitCode::done : ExitCode::incomplete);
}

}  // namespace

int main(int argc, char** argv) {
  exports::ExportOptions options{.dataset = "", .output = "", .format = "", .jobs = jobs::available_cores()};
  bool quiet = false;
  CLI::App app("Writes a data set of generate_dataset in a format that other tools read.");
  app.footer(kExamples);
  app.set_version_flag("--version", tool_version());
  app.add_option("DATASET", options.dataset, "Folder of the data set")->required();
  app.add_option("-f,--format", options.format, "What to write")
      ->required()
      ->check(CLI::IsMember(exports::export_format_names()));
  app.add_option("-o,--output", options.output, "Folder of the export")->required()->type_name("DIR");
  app.add_flag("--crop", options.crop, "Images of the bin's window alone, with the camera adjusted (bop, coco)");
  app.add_flag("--normals", options.normals, "Also the surfaces' normals (npz)");
  app.add_option("-j,--jobs", options.jobs, "Worker processes")->check(CLI::Range(1, 1024))->capture_default_str();
  app.add_flag("-q,--quiet", quiet, "No progress, only errors and results");
  return run_program("export_dataset", app, argc, argv, [&] { return run(options, quiet); });
}
