// Several rays from the scanner at once, and the first solid that each of them has met so far.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "scan/exact_shapes.hpp"
#include "scan/packet_bodies.hpp"
#include "scan/scene_solids.hpp"
#include "tubebin/scene/camera.hpp"

namespace tubebin::scan {

/// The rays of a packet, which are as many as of Embree's, are reckoned in blocks that fill a register of AVX2 each:
/// GCC takes vectors that are longer than a register apart, one number at a time.
constexpr int kLanes = 8;
constexpr int kBlockLanes = 4;
using Lanes = double __attribute__((vector_size(kBlockLanes * sizeof(double))));
using LaneFlags = std::int64_t __attribute__((vector_size(kBlockLanes * sizeof(double))));  ///< all bits or none

struct Hit {
  double depth = std::numeric_limits<double>::infinity();  ///< along the optical axis, metres; infinity: nothing
  cloud::Label label = 0;

  bool found() const { return depth < std::numeric_limits<double>::infinity(); }
};

class RayPacket {
 public:
  /// At most kLanes directions; the last fills the lanes that are left. Depths below depth_min don't count.
  RayPacket(std::span<const Vec3> directions, double depth_min);
  /// Through the pixel and those to its right.
  RayPacket(const scene::Camera& camera, int column, int row, double depth_min);

  /// The points of the pixels from (column, row) on to the right, as packets give them that are offered these `boxes` of the
  /// bin, forget what lies beyond depth_max, and meet nothing else: most pixels are such. Returns false, and leaves the
  /// points unsettled, where a ray is special.
  static bool get_bin_points(const scene::Camera& camera, int column, int row, const std::vector<SolidBox>& bin,
                             BoxFlags boxes, double depth_min, double depth_max, std::span<cloud::Point> points);

  /// Each lane takes the solid's first point if it is nearer than what it has. Equal depths go to the lower label, so
  /// that the result does not depend on the order of the solids.
  void offer_bin(const std::vector<SolidBox>& bin, BoxFlags boxes = kAllBoxes);
  void offer(const Labelled<SolidCylinder>& cylinder);
  void offer(const Labelled<SolidSphere>& sphere);
  void offer(const Labelled<SolidBox>& box);

  /// Lowers the lanes' bounds to what is left to search.
  void limit(std::span<float, kLanes> search_ends) const;
  void set_first(int lane, const Hit& hit);
  /// Lanes that have nothing at depth_max or nearer have nothing.
  void forget_beyond(double depth_max);

  Vec3 direction(int lane) const;
  /// Of the first lanes: origin + depth * direction and the label; no number and 0 where nothing is met.
  void get_first_points(const Vec3& origin, std::span<cloud::Point> points, std::span<cloud::Label> labels) const;
  double depth(int lane) const { return block(lane).depth[lane % kBlockLanes]; }
  Hit first(int lane) const { return {depth(lane), static_cast<cloud::Label>(block(lane).label[lane % kBlockLanes])}; }
  /// Whether the first boundary is to be looked for otherwise: the ray begins inside a solid, or enters a hollow tube
  /// through its open end.
  bool is_special(int lane) const {
    return (block(lane).begins_inside[lane % kBlockLanes] | block(lane).enters_bore[lane % kBlockLanes]) != 0;
  }
  /// Whether a lane is.
  bool has_special() const;

 private:
  struct Block {
    DirectionOf<Lanes> directions;
    Lanes depth = Lanes{} + std::numeric_limits<double>::infinity();
    LaneFlags label = {};
    LaneFlags begins_inside = {};
    LaneFlags enters_bore = {};  ///< at `depth`

    void aim(const Lanes& x, double y, const scene::Camera& camera, const Eigen::Matrix3d& axes);
    void offer_bin(const std::vector<SolidBox>& bin, BoxFlags boxes, double depth_min);
    void forget_beyond(double depth_max);
    void get_points(const Vec3& origin, std::span<cloud::Point> points) const;
    void take(const IntervalOf<Lanes>& inside, cloud::Label label_inside, double depth_min);
    void take(const SolidBox& box, const DirectionOf<Lanes>& inverse, cloud::Label label_inside, double depth_min);
  };

  const Block& block(int lane) const { return blocks_[static_cast<std::size_t>(lane / kBlockLanes)]; }
  void aim(const scene::Camera& camera, int column, int row);
  template <typename Solid>
  void offer_solid(const Labelled<Solid>& solid);
  template <typename Solid>
  void check_bore(const Labelled<Solid>& solid);

  std::array<Block, kLanes / kBlockLanes> blocks_;
  double depth_min_;
};

}  // namespace tubebin::scan
