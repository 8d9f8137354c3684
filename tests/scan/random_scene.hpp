// Scenes for tests: tubes by the paper's algorithms, thrown anywhere into the bin's space (they may
// intersect).
#pragma once

#include "tubebin/scene/scene.hpp"
#include "tubebin/tube/tube_generator.hpp"

namespace tubebin::testing {

inline scene::Scene random_scene(int tube_count, std::uint64_t seed) {
  Random random(seed);
  scene::Scene scene;
  tube::TubeOptions options;
  options.bend_angle_max_deg = 45.0;
  for (const tube::Tube& tube : tube::generate_tubes(tube_count, options, random)) {
    const Quat rotation = random.rotation();
    const Vec3 middle = rotation * (0.5 * (tube.nodes.front() + tube.nodes.back()));
    const Vec3 place(random.uniform(-0.15, 0.15), random.uniform(-0.1, 0.1), random.uniform(0.02, 0.25));
    scene.tubes.push_back({tube, make_pose(rotation, place - middle)});
  }
  return scene;
}

/// The scanner that sees the bin in all of a small image.
inline void look_closely(scene::Scanner& scanner, int width, int height) {
  scanner.width = width;
  scanner.height = height;
  scanner.horizontal_fov_deg = 22.0;
}

}  // namespace tubebin::testing
