/// 1_generate_scene SEED: ten tubes fall into a bin; scene.json tells where each came to rest.
#include <iostream>

#include "tubebin/cloud/label_colors.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/physics/drop_simulator.hpp"
#include "tubebin/scene/scene_json.hpp"
#include "tubebin/tube/tube_generator.hpp"

int main(int argc, char** argv) {
  using namespace tubebin;
  constexpr int kTubes = 10;
  const std::uint64_t seed = argc > 1 ? std::stoull(argv[1]) : 1;
  Random random(seed);

  const std::vector<tube::Tube> tubes = tube::generate_tubes(kTubes, tube::TubeOptions{}, random);
  scene::SceneRecord record{.id = "example", .seed = seed, .scene = {}, .window = {}};
  physics::DropResult drop = physics::drop_tubes(tubes, record.scene.bin, physics::PhysicsOptions{}, random.bits());
  if (drop.failure != physics::DropFailure::none) {
    std::cerr << drop.detail << "; try another seed\n";
    return 3;
  }

  record.scene.tubes = std::move(drop.tubes);
  record.contacts = std::move(drop.contacts);
  record.colors = cloud::label_colors(kTubes);
  record.tube_pixels.assign(kTubes, 0);  // not scanned yet
  write_file_atomically("scene.json", scene::format_scene_json(record));
  std::cout << kTubes << " tubes at rest after " << drop.figures.simulated_seconds << " s, " << record.contacts.size()
            << " contacts\n";
}
