// First surfaces along rays from the scanner: Embree finds the solids near a ray, double precision
// decides.
#pragma once

#include <memory>
#include <span>

#include "scan/embree.hpp"
#include "scan/mesh_caster.hpp"
#include "scan/ray_packet.hpp"
#include "scan/scene_solids.hpp"

namespace tubebin::scan {

/// Metres. A floor at exactly range_max is within range whatever the rounding of a ray's direction.
constexpr double kDepthTolerance = 1e-9;

/// Where a body that consists of convex solids first begins or ends at depth_min or beyond; `parts`, its solids along the
/// ray, are sorted.
double first_boundary(std::vector<Interval>& parts, double depth_min);
/// The same of a body that consists of convex solids without their convex `bores`; both are sorted. Gaps and walls below
/// a nanometre are rounding.
double first_boundary(std::vector<Interval>& parts, std::vector<Interval>& bores, double depth_min);

class RayCaster {
 public:
  /// Depths within [depth_min, depth_max] count.
  RayCaster(SceneSolids solids, double depth_min, double depth_max);
  RayCaster(const RayCaster&) = delete;  // Embree holds pointers to the solids
  RayCaster& operator=(const RayCaster&) = delete;

  const SceneSolids& solids() const { return solids_; }
  double depth_min() const { return depth_min_; }  ///< metres, less the rounding that is allowed for

  /// The first surface of a tube or of the bin along the ray at depth depth_min or beyond. Where the ray
  /// begins inside a solid that is the surface through which it leaves (or enters another tube); faces
  /// between the solids of one body are no surface. Through a hollow tube's open end the ray goes on within its bore.
  /// `direction`: Camera::direction_in_world.
  Hit first_hit(const Vec3& direction) const;
  /// The first hits of a new packet's first `count` rays, which meet no other `bodies` than these: of each lane,
  /// in the packet itself, infinitely deep where nothing is hit. Faster for rays side by side than one at a time.
  void find_first_hits(RayPacket& packet, int count, const BodiesInReach& bodies) const;
  /// The points of the pixels from (column, row) on to the right, whose rays meet no more than these boxes of the bin. Faster
  /// than by packets. Returns false, and leaves the points unsettled, where that does not decide.
  bool find_bin_points(const scene::Camera& camera, int column, int row, BoxFlags boxes,
                       std::span<cloud::Point> points) const;

 private:
  void offer_few(RayPacket& packet, const BodiesInReach& bodies) const;
  void offer_by_tree(RayPacket& packet, int count) const;
  /// What Embree's search has left undecided.
  void decide(RayPacket& packet, int count) const;
  /// As first_hit, looking at every boundary of every body.
  Hit first_boundary_hit(const Vec3& direction) const;

  SceneSolids solids_;
  double depth_min_;
  double depth_max_;
  embree::Scene scene_;
  std::unique_ptr<MeshCaster> mesh_;  // of the bin, if it has one
};

}  // namespace tubebin::scan
