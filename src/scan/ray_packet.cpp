#include "scan/ray_packet.hpp"

#include <algorithm>

#include "tubebin/core/wide.hpp"

namespace tubebin {

RayPacket::RayPacket(std::span<const Vec3> directions, double depth_min) : depth_min_(depth_min) {
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const Vec3& direction = directions[std::min(lane, directions.size() - 1)];
    Block& block = blocks_[lane / kBlockLanes];
    block.directions.x[lane % kBlockLanes] = direction.x();
    block.directions.y[lane % kBlockLanes] = direction.y();
    block.directions.z[lane % kBlockLanes] = direction.z();
    block.depth[lane % kBlockLanes] = std::numeric_limits<double>::infinity();
  }
}

Vec3 RayPacket::direction(int lane) const {
  const DirectionOf<Lanes>& directions = block(lane).directions;
  return {directions.x[lane % kBlockLanes], directions.y[lane % kBlockLanes], directions.z[lane % kBlockLanes]};
}

[[gnu::always_inline]] inline void RayPacket::Block::take(const IntervalOf<Lanes>& inside, Label label_inside,
                                                          double depth_min) {
  const LaneFlags met = (inside.begin <= inside.end) & (inside.end >= depth_min);
  begins_inside |= met & (inside.begin < depth_min);
  const LaneFlags labels = LaneFlags{} + static_cast<std::int64_t>(label_inside);
  const LaneFlags nearer = met & ((inside.begin < depth) | ((inside.begin == depth) & (labels < label)));
  depth = nearer ? inside.begin : depth;
  label = nearer ? labels : label;
  enters_bore &= ~nearer;
}

template <typename Solid>
[[gnu::always_inline]] inline void RayPacket::offer_solid(const Labelled<Solid>& solid) {
  for (Block& block : blocks_) {
    IntervalOf<Lanes> inside;
    solid.solid.intersect(block.directions, solid.solid.radius(), inside);
    block.take(inside, solid.label, depth_min_);
  }
  if (solid.bore_radius > 0.0) check_bore(solid);
}

TUBEBIN_WIDE void RayPacket::offer_bin(const std::vector<Box>& bin) {
  for (Block& block : blocks_) {
    DirectionOf<Lanes> inverse;
    invert(block.directions, inverse);
    for (const Box& box : bin) {
      IntervalOf<Lanes> inside;
      intersect(box, inverse, inside);
      block.take(inside, 0, depth_min_);
    }
  }
}

TUBEBIN_WIDE void RayPacket::offer(const Labelled<SolidCylinder>& cylinder) { offer_solid(cylinder); }

TUBEBIN_WIDE void RayPacket::offer(const Labelled<SolidSphere>& sphere) { offer_solid(sphere); }

/// Only a cap's plane gives the solid and its bore the same first point.
template <typename Solid>
void RayPacket::check_bore(const Labelled<Solid>& solid) {
  for (int lane = 0; lane < kLanes; ++lane) {
    Block& block = blocks_[static_cast<std::size_t>(lane / kBlockLanes)];
    const Hit hit = first(lane);
    const Interval whole = solid.solid.intersect(direction(lane));
    if (hit.label != solid.label || whole.empty() || hit.depth != whole.begin) continue;
    const Interval bore = solid.solid.intersect(direction(lane), solid.bore_radius);
    if (!bore.empty() && bore.begin == whole.begin) block.enters_bore[lane % kBlockLanes] = -1;
  }
}

}  // namespace tubebin
