/// 2_scan_scene: a virtual 3D scanner above the bin of scene.json sees the labelled cloud cloud.pcd, and scene.json
/// gets to know how much of each tube.
#include <iostream>

#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/scan/scanner.hpp"
#include "tubebin/scene/scene_json.hpp"

int main() try {
  using namespace tubebin;
  scene::SceneRecord record = scene::read_scene_json("scene.json");
  record.scene.scanner.position = {0.0, 0.0, 1.8};          // metres, over the middle of the bin
  record.scene.scanner.effects.range_noise.sigma = 0.0002;  // metres, at 1 m

  const scan::Scan scan = scan::scan(record.scene, record.seed);
  cloud::write_cloud("cloud.pcd", scan.cloud, cloud::CloudFormat::pcd_binary);
  record.window = scan.window;
  record.tube_pixels = scan.tube_pixels;
  write_file_atomically("scene.json", scene::format_scene_json(record));
  std::cout << scan.cloud.width << " x " << scan.cloud.height << " pixels\n";
  for (std::size_t k = 1; k <= scan.tube_pixels.size(); ++k)
    std::cout << "tube " << k << ": " << scan.tube_pixels[k - 1] << " points\n";
} catch (const tubebin::IoError& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
