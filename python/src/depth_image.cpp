// Depth images as arrays.
#include "depth_image.hpp"

#include "tubebin/scene/camera.hpp"

namespace tubebin::python {

DepthImage::DepthImage(const scene::DepthImage& image, const scene::SceneRecord& record)
    : height(static_cast<std::size_t>(image.height)),
      width(static_cast<std::size_t>(image.width)),
      labels(image.labels.begin(), image.labels.end()) {
  const scene::Camera camera(record.scene.scanner);
  intrinsics = camera.intrinsics(record.window);
  world_from_camera = camera.world_from_scanner();
  depth.reserve(image.depths.size());
  for (const std::uint16_t units : image.depths)
    depth.push_back(static_cast<float>(units * image.mm_per_unit / 1000.0));
}

void bind_depth_image(nb::module_& module) {
  nb::class_<DepthImage>(module, "DepthImage",
                         "What a scene's scanner measured as an image, pixel by pixel its organized cloud. The arrays "
                         "depth and labels are views of its memory.")
      .def_prop_ro(
          "depth",
          [](nb::handle self) {
            DepthImage& image = nb::cast<DepthImage&>(self);
            return per_point(image.depth, image.height, image.width, true, self);
          },
          "(H, W) float32, metres along the camera's optical axis; 0 where nothing was measured.")
      .def_prop_ro(
          "labels",
          [](nb::handle self) {
            DepthImage& image = nb::cast<DepthImage&>(self);
            return per_point(image.labels, image.height, image.width, true, self);
          },
          "(H, W) uint32, k of tube k, 0 of the bin and where nothing was measured.")
      .def_prop_ro(
          "intrinsics", [](const DepthImage& self) { return array_of(self.intrinsics); }, nb::rv_policy::automatic,
          "(3, 3) float64, [f 0 cx; 0 f cy; 0 0 1] of these pixels, whose centres lie at halves. A copy.")
      .def_prop_ro(
          "viewpoint", [](const DepthImage& self) { return array_of(self.world_from_camera); },
          nb::rv_policy::automatic,
          "(4, 4) float64, world frame from camera frame (x right, y down, z along the view), metres. A copy.");
}

}  // namespace tubebin::python
