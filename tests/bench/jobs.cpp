/// The three small, fixed jobs whose instructions are counted (scripts/instruction_counts.sh): bench_jobs JOB, where JOB
/// is generate, model or evaluate. Only what happens within run_job() counts; the rest prepares.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "support/synthetic_results.hpp"
#include "tubebin/dataset/generate_scene.hpp"
#include "tubebin/results/model_cloud.hpp"
#include "tubebin/results/results_folder.hpp"

namespace tubebin {
namespace {

using Job = std::function<std::size_t()>;

/// Three tubes, dropped and scanned; without writing, whose cost is the disk's.
Job generate() {
  dataset::DatasetConfig config;
  config.scanner.width = 640;
  config.scanner.height = 400;
  return [config] {
    dataset::GeneratedScene scene;
    for (int attempt = 0; attempt == 0 || !scene.failure.empty(); ++attempt)
      scene = dataset::generate_scene(config, {.set = "A", .tubes = 3, .case_number = 1}, attempt);
    return scene.content.cloud.size();
  };
}

Job model() {
  return [] {
    const results::CloudToModel input = results::read_cloud_to_model(TUBEBIN_SOURCE_DIR "/data/A10/003/cloud.pcd");
    return results::model_cloud(input, results::ModelConfig{}).tubes.size();
  };
}

Job evaluate() {
  const auto folder = std::make_shared<testing::TemporaryFolder>();
  testing::write_synthetic_sweep(folder->path(), {});
  return [folder] { return results::read_results({folder->path() / "results"}, {}).runs.size(); };
}

}  // namespace
}  // namespace tubebin

/// By this name callgrind knows when to count.
extern "C" [[gnu::noinline]] std::size_t tubebin_run_job(const std::function<std::size_t()>& job) { return job(); }

int main(int argc, char** argv) try {
  // Other threads' instructions would not count.
  const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
  const std::map<std::string, tubebin::Job (*)()> jobs = {
      {"generate", tubebin::generate}, {"model", tubebin::model}, {"evaluate", tubebin::evaluate}};
  const auto job = argc == 2 ? jobs.find(argv[1]) : jobs.end();
  if (job == jobs.end()) tubebin::throw_config_error("usage: bench_jobs generate|model|evaluate");
  return tubebin_run_job(job->second()) > 0 ? 0 : 1;
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 2;
}
