#include "scan/packet_bodies.hpp"

#include <algorithm>

#include "scan/ray_packet.hpp"
#include "scan/solid_outline.hpp"
#include "scan/view_window.hpp"

namespace tubebin::scan {

PacketBodies::PacketBodies(const SceneSolids& solids, const scene::Camera& camera, const scene::PixelWindow& window,
                           double depth_min)
    : window_(window),
      packets_in_row_(static_cast<std::size_t>((window.width + kLanes - 1) / kLanes)),
      packets_(packets_in_row_ * static_cast<std::size_t>(window.height)) {
  std::uint32_t solid = 0;
  const auto add_solid = [&](const auto& outline) {
    const scene::PixelWindow& rows = outline.window();
    for (int row = rows.y; row < rows.y + rows.height; ++row) {
      const Columns columns = outline.columns(row);
      for_each_packet(row, columns.begin, columns.end, [&](BodiesInReach& bodies) {
        if (bodies.solid_count < BodiesInReach::kFew) bodies.solids[bodies.solid_count] = solid;
        ++bodies.solid_count;
      });
    }
    ++solid;
  };
  for (const auto& cylinder : solids.cylinders) add_solid(CylinderOutline(cylinder.solid, camera, depth_min));
  for (const auto& sphere : solids.spheres) add_solid(SphereOutline(sphere.solid, camera, depth_min));
  for (const auto& cylinder : solids.cylinders_around) add_solid(CylinderOutline(cylinder.solid, camera, depth_min));
  for (const auto& box : solids.boxes_around) add_solid(BoxOutline(box.solid, camera, depth_min));
  for (std::size_t box = 0; box < solids.bin.size(); ++box) {
    const scene::PixelWindow seen = BoxOutline(solids.bin[box], camera, depth_min).window();
    for (int row = seen.y; row < seen.y + seen.height; ++row)
      for_each_packet(row, seen.x, seen.x + seen.width, [&](BodiesInReach& bodies) { bodies.boxes |= box_flag(box); });
  }
}

std::size_t PacketBodies::index(int column, int row) const {
  return static_cast<std::size_t>(row - window_.y) * packets_in_row_ +
         static_cast<std::size_t>((column - window_.x) / kLanes);
}

template <typename Add>
void PacketBodies::for_each_packet(int row, int begin, int end, const Add& add) {
  begin = std::max(begin, window_.x);
  end = std::min(end, window_.x + window_.width);
  if (begin >= end || row < window_.y || row >= window_.y + window_.height) return;
  for (std::size_t i = index(begin, row); i <= index(end - 1, row); ++i) add(packets_[i]);
}

}  // namespace tubebin::scan
