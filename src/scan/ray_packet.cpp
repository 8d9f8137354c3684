#include "scan/ray_packet.hpp"

#include "scan/embree.hpp"
#include "tubebin/core/wide.hpp"

namespace tubebin::scan {

RayPacket::RayPacket(std::span<const Vec3> directions, double depth_min) : depth_min_(depth_min) {
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const Vec3& direction = directions[std::min(lane, directions.size() - 1)];
    Block& block = blocks_[lane / kBlockLanes];
    block.directions.x[lane % kBlockLanes] = direction.x();
    block.directions.y[lane % kBlockLanes] = direction.y();
    block.directions.z[lane % kBlockLanes] = direction.z();
  }
}

RayPacket::RayPacket(const scene::Camera& camera, int column, int row, double depth_min) : depth_min_(depth_min) {
  aim(camera, column, row);
}

namespace {

/// In the image, of the pixel and those to its right.
[[gnu::always_inline]] inline void set_centers(int column, Lanes& x) {
  for (int lane = 0; lane < kBlockLanes; ++lane) x[lane] = column + lane + 0.5;
}

/// Of a row's centre beside the image's, for a ray of depth one.
double slope_down(const scene::Camera& camera, int row) {
  return (row + 0.5 - camera.height() / 2.0) / camera.focal_length();
}

}  // namespace

/// As Camera::direction_in_world, whose axes these are.
[[gnu::always_inline]] inline void RayPacket::Block::aim(const Lanes& x, double y, const scene::Camera& camera,
                                                         const Eigen::Matrix3d& axes) {
  const Lanes across = (x - camera.width() / 2.0) / camera.focal_length();
  directions.x = axes(0, 0) * across + axes(0, 1) * y + axes(0, 2);
  directions.y = axes(1, 0) * across + axes(1, 1) * y + axes(1, 2);
  directions.z = axes(2, 0) * across + axes(2, 1) * y + axes(2, 2);
}

TUBEBIN_WIDE void RayPacket::aim(const scene::Camera& camera, int column, int row) {
  const Eigen::Matrix3d axes = camera.world_from_scanner().linear();
  Lanes x;
  set_centers(column, x);
  for (Block& block : blocks_) {
    block.aim(x, slope_down(camera, row), camera, axes);
    x += kBlockLanes;
  }
}

Vec3 RayPacket::direction(int lane) const {
  const DirectionOf<Lanes>& directions = block(lane).directions;
  return {directions.x[lane % kBlockLanes], directions.y[lane % kBlockLanes], directions.z[lane % kBlockLanes]};
}

[[gnu::always_inline]] inline void RayPacket::Block::take(const IntervalOf<Lanes>& inside, cloud::Label label_inside,
                                                          double depth_min) {
  const LaneFlags met = (inside.begin <= inside.end) & (inside.end >= depth_min);
  begins_inside |= met & (inside.begin < depth_min);
  const LaneFlags labels = LaneFlags{} + static_cast<std::int64_t>(label_inside);
  const LaneFlags nearer = met & ((inside.begin < depth) | ((inside.begin == depth) & (labels < label)));
  depth = nearer ? inside.begin : depth;
  label = nearer ? labels : label;
  enters_bore &= ~nearer;
}

/// `inverse`: of the directions, for boxes that are not turned.
[[gnu::always_inline]] inline void RayPacket::Block::take(const SolidBox& box, const DirectionOf<Lanes>& inverse,
                                                          cloud::Label label_inside, double depth_min) {
  IntervalOf<Lanes> inside;
  if (box.is_turned()) {
    DirectionOf<Lanes> own;
    box.turn(directions, own);
    invert(own, own);
    intersect(box.box(), own, inside);
  } else {
    intersect(box.box(), inverse, inside);
  }
  take(inside, label_inside, depth_min);
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

TUBEBIN_WIDE void RayPacket::limit(std::span<float, kLanes> search_ends) const {
  std::array<float, kLanes> own;
  for (std::size_t i = 0; i < blocks_.size(); ++i)
    for (std::size_t lane = 0; lane < kBlockLanes; ++lane)
      own[i * kBlockLanes + lane] = embree::search_end(blocks_[i].depth[lane]);
  for (std::size_t lane = 0; lane < kLanes; ++lane) search_ends[lane] = std::min(search_ends[lane], own[lane]);
}

void RayPacket::set_first(int lane, const Hit& hit) {
  Block& of = blocks_[static_cast<std::size_t>(lane / kBlockLanes)];
  of.depth[lane % kBlockLanes] = hit.depth;
  of.label[lane % kBlockLanes] = static_cast<std::int64_t>(hit.label);
}

[[gnu::always_inline]] inline void RayPacket::Block::forget_beyond(double depth_max) {
  const LaneFlags near = depth <= depth_max;
  depth = near ? depth : Lanes{} + std::numeric_limits<double>::infinity();
  label &= near;
}

TUBEBIN_WIDE void RayPacket::forget_beyond(double depth_max) {
  for (Block& block : blocks_) block.forget_beyond(depth_max);
}

/// Of the first lanes.
[[gnu::always_inline]] inline void RayPacket::Block::get_points(const Vec3& origin,
                                                                std::span<cloud::Point> points) const {
  using Singles = float __attribute__((vector_size(kBlockLanes * sizeof(float))));
  const LaneFlags found = depth < std::numeric_limits<double>::infinity();
  const Lanes none = Lanes{} + std::numeric_limits<double>::quiet_NaN();
  const Singles x = __builtin_convertvector(found ? origin.x() + depth * directions.x : none, Singles);
  const Singles y = __builtin_convertvector(found ? origin.y() + depth * directions.y : none, Singles);
  const Singles z = __builtin_convertvector(found ? origin.z() + depth * directions.z : none, Singles);
  if (points.size() >= kBlockLanes)
    for (std::size_t lane = 0; lane < kBlockLanes; ++lane) points[lane] = {x[lane], y[lane], z[lane]};
  else
    for (std::size_t lane = 0; lane < points.size(); ++lane) points[lane] = {x[lane], y[lane], z[lane]};
}

TUBEBIN_WIDE void RayPacket::get_first_points(const Vec3& origin, std::span<cloud::Point> points,
                                              std::span<cloud::Label> labels) const {
  for (std::size_t begin = 0; begin < points.size(); begin += kBlockLanes) {
    const Block& of = blocks_[begin / kBlockLanes];
    of.get_points(origin, points.subspan(begin));
    const LaneFlags label = (of.depth < std::numeric_limits<double>::infinity()) & of.label;
    const std::size_t count = std::min<std::size_t>(kBlockLanes, points.size() - begin);
    for (std::size_t lane = 0; lane < count; ++lane) labels[begin + lane] = static_cast<cloud::Label>(label[lane]);
  }
}

bool RayPacket::has_special() const {
  LaneFlags special = {};
  for (const Block& block : blocks_) special |= block.begins_inside | block.enters_bore;
  bool any = false;
  for (int lane = 0; lane < kBlockLanes; ++lane) any |= special[lane] != 0;
  return any;
}

[[gnu::always_inline]] inline void RayPacket::Block::offer_bin(const std::vector<SolidBox>& bin, BoxFlags boxes,
                                                               double depth_min) {
  DirectionOf<Lanes> inverse;
  invert(directions, inverse);
  for (std::size_t i = 0; i < bin.size(); ++i)
    if (boxes & box_flag(i)) take(bin[i], inverse, 0, depth_min);
}

TUBEBIN_WIDE void RayPacket::offer_bin(const std::vector<SolidBox>& bin, BoxFlags boxes) {
  for (Block& block : blocks_) block.offer_bin(bin, boxes, depth_min_);
}

TUBEBIN_WIDE bool RayPacket::get_bin_points(const scene::Camera& camera, int column, int row,
                                            const std::vector<SolidBox>& bin, BoxFlags boxes, double depth_min,
                                            double depth_max, std::span<cloud::Point> points) {
  if (boxes == 0) {  // beside the bin, in the window of tubes that lean out of it
    std::ranges::fill(points, cloud::Point::Constant(std::numeric_limits<float>::quiet_NaN()));
    return true;
  }
  const Eigen::Matrix3d axes = camera.world_from_scanner().linear();
  const Vec3 origin = camera.world_from_scanner().translation();
  const double y = slope_down(camera, row);
  Lanes x;
  set_centers(column, x);
  LaneFlags special = {};
  for (std::size_t begin = 0; begin < points.size(); begin += kBlockLanes) {
    Block block;
    block.aim(x, y, camera, axes);
    block.offer_bin(bin, boxes, depth_min);
    special |= block.begins_inside;
    block.forget_beyond(depth_max);
    block.get_points(origin, points.subspan(begin));
    x += kBlockLanes;
  }
  bool any = false;
  for (int lane = 0; lane < kBlockLanes; ++lane) any |= special[lane] != 0;
  return !any;
}

TUBEBIN_WIDE void RayPacket::offer(const Labelled<SolidBox>& box) {
  for (Block& block : blocks_) {
    DirectionOf<Lanes> inverse;
    invert(block.directions, inverse);
    block.take(box.solid, inverse, box.label, depth_min_);
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

}  // namespace tubebin::scan
