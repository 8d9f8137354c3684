// A scene's drop for docs/physics.md: drop_stages CONFIG.yaml TUBES SECONDS prints where the tubes of its first case are when
// they start, SECONDS later and at rest, as JSON: [[{"radius": m, "nodes": [[x, y, z], ...]}, ...], ...] in the world frame.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "physics/rigid_world.hpp"
#include "physics/spawn.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/dataset/generate_scene.hpp"

namespace {

using namespace tubebin;

nlohmann::json nodes_of(const std::vector<scene::PlacedTube>& tubes) {
  nlohmann::json stage;
  for (const scene::PlacedTube& tube : tubes) {
    nlohmann::json nodes;
    for (int k = 0; k < static_cast<int>(tube.tube.nodes.size()); ++k) {
      const Vec3 node = tube.node_in_world(k);
      nodes.push_back({node.x(), node.y(), node.z()});
    }
    stage.push_back({{"radius", tube.tube.radius}, {"nodes", nodes}});
  }
  return stage;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 4) throw_config_error("usage: drop_stages CONFIG.yaml TUBES SECONDS");
  const dataset::DatasetConfig config = dataset::load_config(argv[1]);
  const dataset::SceneId id{.set = config.set, .tubes = std::stoi(argv[2]), .case_number = 1};
  Random random(dataset::attempt_seed(config, id, 1));
  const std::vector<tube::Tube> tubes = tube::generate_tubes(id.tubes, config.tube, random);
  const std::uint64_t seed = random.bits();

  Random spawning(seed);  // as drop_tubes does
  const auto spawned = physics::spawn(tubes, config.bin, config.physics, spawning);
  if (!spawned) throw_config_error("{}: the tubes do not fit above the bin", argv[1]);
  physics::RigidWorld world(*spawned, config.bin, config.physics);
  for (double time = 0.0; time < std::stod(argv[3]); time += config.physics.time_step)
    world.step(config.physics.time_step);

  const physics::DropResult rest = physics::drop_tubes(tubes, config.bin, config.physics, seed);
  if (rest.failure != physics::DropFailure::none) throw_config_error("{}: the drop failed: {}", argv[1], rest.detail);
  fmt::print("{}\n", nlohmann::json{nodes_of(*spawned), nodes_of(world.tubes()), nodes_of(rest.tubes)}.dump());
} catch (const std::exception& error) {
  fmt::print(stderr, "drop_stages: {}\n", error.what());
  return 1;
}
