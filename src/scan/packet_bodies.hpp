// Which bodies the rays of a packet may meet.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scan/scene_solids.hpp"
#include "tubebin/scene/camera.hpp"

namespace tubebin::scan {

/// A bit for each of the bin's boxes.
using BoxFlags = std::uint64_t;
constexpr BoxFlags box_flag(std::size_t box) { return BoxFlags{1} << box; }
constexpr BoxFlags kAllBoxes = ~BoxFlags{0};

/// Of the solids of the tubes and of what stands around, the i-th.
template <typename Visit>
void visit_solid(const SceneSolids& solids, std::size_t i, const Visit& visit) {
  const auto visit_in = [&](const auto& some) {
    if (i < some.size()) return visit(some[i]), true;
    i -= some.size();
    return false;
  };
  visit_in(solids.cylinders) || visit_in(solids.spheres) || visit_in(solids.cylinders_around) ||
      visit_in(solids.boxes_around);
}

/// The bodies that a packet may meet. Of the solids beside the bin's it names a few; where there are more, a search tree
/// is the shorter way.
struct BodiesInReach {
  static constexpr std::size_t kFew = 6;

  BoxFlags boxes = 0;
  std::uint32_t solid_count = 0;
  std::array<std::uint32_t, kFew> solids{};  ///< the first of them, as numbered by visit_solid
};

/// Packets lie side by side in the rows of a window, the first at its left side.
class PacketBodies {
 public:
  /// Bodies that are seen at depth_min (metres) or beyond count. At most 64 boxes.
  PacketBodies(const SceneSolids& solids, const scene::Camera& camera, const scene::PixelWindow& window,
               double depth_min);

  /// Of the packet that begins at a pixel of the window. Its rays meet no others.
  const BodiesInReach& at(int column, int row) const { return packets_[index(column, row)]; }

 private:
  std::size_t index(int column, int row) const;
  template <typename Add>
  void for_each_packet(int row, int begin, int end, const Add& add);

  scene::PixelWindow window_;
  std::size_t packets_in_row_;
  std::vector<BodiesInReach> packets_;
};

}  // namespace tubebin::scan
