#include "modeling/input/bin_faces.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "modeling/input/bin_finding.hpp"

namespace tubebin::modeling {
namespace {

/// The bin, as far out as its walls may lean.
Eigen::AlignedBox3d box_about(const BinFound& bin, double margin) {
  const Vec3 half(bin.length / 2.0 + kLean * bin.height, bin.width / 2.0 + kLean * bin.height, 0.0);
  return {-half - Vec3::Constant(margin), half + Vec3(margin, margin, bin.height + margin)};
}

}  // namespace

std::vector<std::uint32_t> points_on_faces(const BinFound& bin, const std::vector<FlatRegion>& regions,
                                           std::span<const cloud::Point> points, std::span<const std::uint32_t> indices,
                                           double margin) {
  const Pose bin_from_world = bin.world_from_bin.inverse();
  const Eigen::AlignedBox3d box = box_about(bin, margin);
  std::vector<FlatRegion> faces;
  std::ranges::copy_if(regions, std::back_inserter(faces), [&](const FlatRegion& region) {
    const Vec3 center = bin_from_world * region.center;
    const bool is_wall = std::abs((bin_from_world.linear() * region.plane.normal).z()) < kLean;
    return box.contains(center) && (is_wall || std::abs(center.z()) < region.tolerance);
  });
  std::vector<std::uint32_t> on_faces;
  std::ranges::copy_if(indices, std::back_inserter(on_faces), [&](std::uint32_t i) {
    const Vec3 p = points[i].cast<double>();
    const auto is_on = [&](const FlatRegion& face) { return face.lies_on_plane(p); };
    return std::ranges::any_of(faces, is_on) && box.contains(bin_from_world * p);
  });
  return on_faces;
}

}  // namespace tubebin::modeling
