/// Each point's nearest points in space, however densely they lie.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tubebin/cloud/cloud.hpp"

namespace tubebin::modeling {

/// A k-d tree, exact. Which of several points equally far are taken is decided by the order of the search, and this is
/// FLANN's KDTreeSingleIndex's, which PCL searches.
class NearestNeighbors {
 public:
  explicit NearestNeighbors(std::span<const cloud::Point> points);

  /// Indices of the `count` points nearest to `query`, nearest first, a point there included; all where there are fewer.
  std::vector<std::uint32_t> find(const cloud::Point& query, std::size_t count) const;

 private:
  /// The points of a range of order_, halved across an axis or, where they are few, not.
  struct Node {
    std::uint32_t first, last;
    int axis = 0;
    float lower_end = 0.0f, upper_begin = 0.0f;  ///< of its halves along the axis, metres
    std::uint32_t lower = 0, upper = 0;          ///< nodes; 0 of a leaf
  };
  struct Search;

  std::uint32_t add_node(std::uint32_t first, std::uint32_t last);
  /// Sorts the range into two halves; where the upper one begins.
  std::uint32_t halve(std::uint32_t first, std::uint32_t last, int axis, float cut);
  void search(const Node& node, Search& search) const;

  std::span<const cloud::Point> points_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace tubebin::modeling
