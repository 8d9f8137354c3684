// Prints docs/physics.md's table: what each physics setting costs and what it leaves, one varied at a time.
// Usage: physics_table [tubes] [scenes]
#include <fmt/format.h>

#include <ctime>
#include <map>

#include "tubebin/physics/drop_simulator.hpp"
#include "tubebin/tube/tube_generator.hpp"

using namespace tubebin;

namespace {

struct Outcome {
  int good = 0;
  std::map<std::string, int> failures;
  double cpu_seconds = 0.0;
  double steps = 0.0;
  double deepest_penetration = 0.0;
  double drift = 0.0;
};

Outcome drop_scenes(int tube_count, int scene_count, const physics::PhysicsOptions& options) {
  Outcome outcome;
  for (int i = 0; i < scene_count; ++i) {
    Random random(derive_seed({1, static_cast<std::uint64_t>(i)}));
    const std::vector<tube::Tube> tubes = tube::generate_tubes(tube_count, {}, random);
    const std::clock_t start = std::clock();
    const physics::DropResult drop = physics::drop_tubes(tubes, scene::Bin{}, options, random.bits());
    outcome.cpu_seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    outcome.steps += drop.figures.steps;
    if (drop.failure != physics::DropFailure::none) {
      ++outcome.failures[to_string(drop.failure)];
      continue;
    }
    ++outcome.good;
    outcome.deepest_penetration = std::max(outcome.deepest_penetration, drop.figures.deepest_penetration);
    outcome.drift += drop.figures.largest_drift;
  }
  return outcome;
}

void print_row(const std::string& name, int tube_count, int scene_count, const physics::PhysicsOptions& options,
               double base) {
  const Outcome o = drop_scenes(tube_count, scene_count, options);
  std::string failures;
  for (const auto& [reason, count] : o.failures)
    failures += fmt::format("{}{} {}", failures.empty() ? "" : ", ", count, reason);
  fmt::print("| {} | {} of {} | {} | {:.0f} | {:.2f} | {:.3f} | {:.3f} |\n", name, o.good, scene_count,
             failures.empty() ? "-" : failures, o.steps / scene_count, o.good ? o.cpu_seconds / o.good / base : 0.0,
             o.deepest_penetration * 1e3, o.good ? o.drift / o.good * 1e3 : 0.0);
}

}  // namespace

int main(int argc, char** argv) {
  const int tube_count = argc > 1 ? std::atoi(argv[1]) : 10;
  const int scene_count = argc > 2 ? std::atoi(argv[2]) : 100;
  const Outcome base = drop_scenes(tube_count, scene_count, {});
  const double unit = base.cpu_seconds / base.good;
  fmt::print("{} tubes, {} drops each; the defaults take {:.1f} ms of processor time a good scene.\n\n", tube_count,
             scene_count, unit * 1e3);
  fmt::print("| setting | good | failed | steps | time, defaults = 1 | deepest penetration, mm | mean drift, mm |\n");
  fmt::print("| --- | --- | --- | --- | --- | --- | --- |\n");
  const auto row = [&](const std::string& name, const std::function<void(physics::PhysicsOptions&)>& change) {
    physics::PhysicsOptions options;
    change(options);
    print_row(name, tube_count, scene_count, options, unit);
  };
  row("defaults", [](physics::PhysicsOptions&) {});
  for (const double step : {0.002, 0.003, 0.005, 0.006})
    row(fmt::format("time_step {}", step), [&](physics::PhysicsOptions& o) { o.time_step = step; });
  for (const int iterations : {15, 60, 120})
    row(fmt::format("solver_iterations {}", iterations),
        [&](physics::PhysicsOptions& o) { o.solver_iterations = iterations; });
  for (const double sor : {1.0, 1.3, 1.8})
    row(fmt::format("solver_over_relaxation {}", sor),
        [&](physics::PhysicsOptions& o) { o.solver_over_relaxation = sor; });
  for (const double rolling : {0.0, 0.0002, 0.002})
    row(fmt::format("rolling_resistance {}", rolling),
        [&](physics::PhysicsOptions& o) { o.rolling_resistance = rolling; });
  for (const double damping : {0.0, 0.05})
    row(fmt::format("damping_angular {}", damping), [&](physics::PhysicsOptions& o) { o.damping_angular = damping; });
  for (const double friction : {0.3, 0.6})
    row(fmt::format("friction_tube, friction_bin {}", friction),
        [&](physics::PhysicsOptions& o) { o.friction_tube = o.friction_bin = friction; });
  for (const double erp : {0.05, 0.8})
    row(fmt::format("contact_erp {}", erp), [&](physics::PhysicsOptions& o) { o.contact_erp = erp; });
  for (const double layer : {0.00001, 0.0003})
    row(fmt::format("contact_layer {}", layer), [&](physics::PhysicsOptions& o) { o.contact_layer = layer; });
}
