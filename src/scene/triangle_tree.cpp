#include "tubebin/scene/triangle_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tubebin::scene {
namespace {

constexpr std::size_t kLeafTriangles = 4;

Eigen::AlignedBox3d bounds_of(const Triangle& triangle) {
  Eigen::AlignedBox3d bounds;
  for (const Vec3& corner : triangle.corners) bounds.extend(corner);
  return bounds;
}

}  // namespace

TriangleTree::TriangleTree(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
  if (!empty()) build(0, 0, triangles_.size());
}

void TriangleTree::build(std::size_t node, std::size_t begin, std::size_t end) {
  const auto at = [&](std::size_t i) { return triangles_.begin() + static_cast<std::ptrdiff_t>(i); };
  Eigen::AlignedBox3d bounds;
  for (std::size_t i = begin; i < end; ++i) bounds.extend(bounds_of(triangles_[i]));
  if (bounds_.size() <= node) bounds_.resize(node + 1);
  bounds_[node] = bounds;
  if (end - begin <= kLeafTriangles) return;
  Eigen::Index longest = 0;
  bounds.sizes().maxCoeff(&longest);
  const std::size_t middle = (begin + end) / 2;
  std::nth_element(at(begin), at(middle), at(end), [&](const Triangle& a, const Triangle& b) {
    return bounds_of(a).center()[longest] < bounds_of(b).center()[longest];
  });
  build(2 * node + 1, begin, middle);
  build(2 * node + 2, middle, end);
}

void TriangleTree::find(const Eigen::AlignedBox3d& box, std::vector<const Triangle*>& found) const {
  if (!empty()) find(0, 0, triangles_.size(), box, found);
}

void TriangleTree::find(std::size_t node, std::size_t begin, std::size_t end, const Eigen::AlignedBox3d& box,
                        std::vector<const Triangle*>& found) const {
  if (!bounds_[node].intersects(box)) return;
  if (end - begin <= kLeafTriangles) {
    for (std::size_t i = begin; i < end; ++i)
      if (bounds_of(triangles_[i]).intersects(box)) found.push_back(&triangles_[i]);
    return;
  }
  const std::size_t middle = (begin + end) / 2;
  find(2 * node + 1, begin, middle, box, found);
  find(2 * node + 2, middle, end, box, found);
}

double TriangleTree::distance(const Vec3& point) const {
  double nearest = std::numeric_limits<double>::infinity();
  if (empty()) return nearest;
  std::vector<const Triangle*> found;
  // A box holds all that is as near as its half side.
  for (double reach = 1e-4;; reach = std::isfinite(nearest) ? nearest : 4.0 * reach) {
    found.clear();
    find({point - Vec3::Constant(reach), point + Vec3::Constant(reach)}, found);
    for (const Triangle* triangle : found) nearest = std::min(nearest, (point - triangle->project(point)).norm());
    if (nearest <= reach || std::isinf(reach)) return nearest;
  }
}

}  // namespace tubebin::scene
