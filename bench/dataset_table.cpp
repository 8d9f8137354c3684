// What a scene costs, stage by stage: dataset_table CONFIG.yaml FOLDER CASES TUBES...
// FOLDER is new and lies on the disk that is to be measured. One process, one Markdown row a number of tubes; times
// are means of wall-clock milliseconds of the attempts that succeeded, "total" has the rejected ones too.
#include <sys/resource.h>

#include <chrono>

#include "tubebin/dataset/generate_scene.hpp"

namespace {

using namespace tubebin;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double peak_resident_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

struct Costs {
  std::map<std::string, double> seconds;
  int rejected = 0;
};

void make_scene(const dataset::DatasetConfig& config, const dataset::SceneStore& store, const dataset::SceneId& id,
                Costs& costs) {
  for (int attempt = 0; attempt < config.attempts_max; ++attempt) {
    const double start = now();
    const dataset::GeneratedScene scene = dataset::generate_scene(config, id, attempt);
    const double generated = now();
    if (scene.failure.empty()) {
      store.begin_write(id.name(), scene.content)();
      costs.seconds["write"] += now() - generated;
      for (const auto& [stage, seconds] : scene.seconds) costs.seconds[stage] += seconds;
    }
    costs.seconds["total"] += now() - start;
    if (scene.failure.empty()) return;
    ++costs.rejected;
  }
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 5) throw_config_error("usage: dataset_table CONFIG.yaml FOLDER CASES TUBES...");
  const dataset::DatasetConfig config = dataset::load_config(argv[1]);
  const dataset::SceneStore store(OutputFolder(argv[2]), config.output);
  const int cases = std::stoi(argv[3]);

  fmt::print("| tubes | build ms | drop ms | scan ms | write ms | total ms | rejected a scene | peak MB |\n");
  fmt::print("| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n");
  for (int i = 4; i < argc; ++i) {
    const int tubes = std::stoi(argv[i]);
    Costs costs;
    for (int case_number = 1; case_number <= cases; ++case_number)
      make_scene(config, store, {config.set, tubes, case_number}, costs);
    const auto mean_ms = [&](const char* stage) { return costs.seconds[stage] / cases * 1e3; };
    fmt::print("| {} | {:.2f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.2f} | {:.0f} |\n", tubes, mean_ms("build"),
               mean_ms("drop"), mean_ms("scan"), mean_ms("write"), mean_ms("total"),
               static_cast<double>(costs.rejected) / cases, peak_resident_megabytes());
    std::fflush(stdout);
  }
} catch (const std::exception& error) {
  fmt::print(stderr, "dataset_table: {}\n", error.what());
  return 1;
}
