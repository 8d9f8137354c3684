// Scenes by emptying piles, beside scenes by a drop each: emptying_table CONFIG.yaml FOLDER PILES LIFTS TUBES...
// FOLDER is new and lies on the disk that is written to. Each pile is dropped with the seed of one and the same case, and
// taken apart by LIFTS lifts; processor time of one process, rejected attempts included.
#include <ctime>

#include "dataset/bins_alone.hpp"
#include "tubebin/core/memory.hpp"
#include "tubebin/dataset/scene_store.hpp"

namespace {

using namespace tubebin;

double now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Costs {
  double seconds = 0.0;
  int scenes = 0;
  int rejected = 0;
  int given_up = 0;                  ///< lifts that another took the place of
  double largest_drift = 0.0;        ///< metres
  double deepest_penetration = 0.0;  ///< metres
  double lift_steps = 0.0;
};

void make_scenes(const dataset::DatasetConfig& config, const dataset::SceneStore& store, const dataset::SceneId& id,
                 int lifts, dataset::BinsAlone& bins_alone, Costs& costs) {
  const double start = now();
  dataset::Piles made = dataset::make_piles(config, id, 0, lifts);
  for (int attempt = 1; !made.failure.empty(); ++attempt, ++costs.rejected) {
    if (attempt == config.attempts_max) throw_io_error("{}: given up: {}", id.name(), made.failure_detail);
    made = dataset::make_piles(config, id, attempt, lifts);
  }
  costs.seconds += now() - start;
  for (std::size_t step = 0; step < made.piles.size(); ++step) {
    const dataset::Pile& pile = made.piles[step];
    dataset::SceneId shown = id;
    if (lifts > 0) shown.step = static_cast<int>(step);
    const double begin = now();
    store.begin_write(shown.name(), dataset::show_pile(made, shown, bins_alone.of(made)).content)();
    costs.seconds += now() - begin;
    store.remove(shown.name());  // or the kernel would look for new memory for each scene
    ++costs.scenes;
    costs.largest_drift = std::max(costs.largest_drift, pile.rest.figures.largest_drift);
    costs.deepest_penetration = std::max(costs.deepest_penetration, pile.rest.figures.deepest_penetration);
    if (!pile.lift) continue;
    costs.lift_steps += pile.rest.figures.steps;
    costs.given_up += static_cast<int>(pile.lift->given_up.size());
  }
}

double milliseconds_a_scene(const Costs& costs) { return costs.seconds / costs.scenes * 1e3; }

}  // namespace

int main(int argc, char** argv) try {
  keep_memory();  // as worker processes do
  if (argc < 6) throw_config_error("usage: emptying_table CONFIG.yaml FOLDER PILES LIFTS TUBES...");
  const dataset::DatasetConfig config = dataset::load_config(argv[1]);
  const dataset::SceneStore store(OutputFolder(argv[2]), config.output);
  const int piles = std::stoi(argv[3]), lifts = std::stoi(argv[4]);

  fmt::print(
      "| tubes | scene by a drop, ms | by emptying, ms | times as many | rejected drops, piles, lifts | steps a lift | "
      "largest drift, mm | deepest penetration, mm |\n| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n");
  for (int i = 5; i < argc; ++i) {
    Costs dropped, emptied;
    dataset::BinsAlone bins_alone;
    for (int case_number = 1; case_number <= piles; ++case_number) {
      const dataset::SceneId id{config.set, std::stoi(argv[i]), case_number};
      make_scenes(config, store, id, 0, bins_alone, dropped);
      make_scenes(config, store, id, lifts, bins_alone, emptied);
    }
    fmt::print("| {} | {:.1f} | {:.1f} | {:.1f} | {}, {}, {} | {:.0f} | {:.2f} | {:.2f} |\n", argv[i],
               milliseconds_a_scene(dropped), milliseconds_a_scene(emptied),
               milliseconds_a_scene(dropped) / milliseconds_a_scene(emptied), dropped.rejected, emptied.rejected,
               emptied.given_up, emptied.lift_steps / (emptied.scenes - piles), emptied.largest_drift * 1e3,
               emptied.deepest_penetration * 1e3);
    std::fflush(stdout);
  }
} catch (const std::exception& error) {
  fmt::print(stderr, "emptying_table: {}\n", error.what());
  return 1;
}
