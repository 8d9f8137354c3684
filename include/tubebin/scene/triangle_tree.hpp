/// Finds the triangles of a mesh that are near.
#pragma once

#include <cstdint>
#include <vector>

#include "tubebin/scene/bin_mesh.hpp"

namespace tubebin::scene {

class TriangleTree {
 public:
  TriangleTree() = default;
  explicit TriangleTree(std::vector<Triangle> triangles);

  bool empty() const { return triangles_.empty(); }
  /// Those whose bounds meet the box, in an order that is always the same.
  void find(const Eigen::AlignedBox3d& box, std::vector<const Triangle*>& found) const;
  /// Metres from the point to the nearest triangle; infinity where there is none.
  double distance(const Vec3& point) const;

 private:
  /// A complete binary tree: node k has the children 2 k + 1 and 2 k + 2 and half of its parent's triangles.
  void build(std::size_t node, std::size_t begin, std::size_t end);
  void find(std::size_t node, std::size_t begin, std::size_t end, const Eigen::AlignedBox3d& box,
            std::vector<const Triangle*>& found) const;

  std::vector<Triangle> triangles_;
  std::vector<Eigen::AlignedBox3d> bounds_;  // of the nodes
};

}  // namespace tubebin::scene
