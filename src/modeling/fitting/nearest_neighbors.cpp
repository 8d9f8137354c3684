#include "modeling/fitting/nearest_neighbors.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace tubebin::modeling {

struct NearestNeighbors::Search {
  struct Candidate {
    float squared_distance;
    std::uint32_t point;
  };

  cloud::Point query;
  std::size_t count;
  std::vector<Candidate> nearest;  ///< by distance; of points equally far, the first one met first

  float worst() const {
    return nearest.size() < count ? std::numeric_limits<float>::infinity() : nearest.back().squared_distance;
  }
  void add(const Candidate& candidate) {
    if (!(candidate.squared_distance < worst())) return;
    if (nearest.size() == count) nearest.pop_back();
    const auto is_nearer = [](float distance, const Candidate& other) { return distance < other.squared_distance; };
    nearest.insert(std::upper_bound(nearest.begin(), nearest.end(), candidate.squared_distance, is_nearer), candidate);
  }
};

NearestNeighbors::NearestNeighbors(std::span<const cloud::Point> points) : points_(points), order_(points.size()) {
  std::iota(order_.begin(), order_.end(), 0U);
  add_node(0, static_cast<std::uint32_t>(points.size()));
}

std::uint32_t NearestNeighbors::add_node(std::uint32_t first, std::uint32_t last) {
  constexpr std::uint32_t kLeaf = 15;
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({.first = first, .last = last});
  if (last - first <= kLeaf) return index;

  const auto box_of = [&](std::uint32_t from, std::uint32_t to) {
    Eigen::AlignedBox3f box;
    for (std::uint32_t k = from; k < to; ++k) box.extend(points_[order_[k]]);
    return box;
  };
  const Eigen::AlignedBox3f box = box_of(first, last);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::uint32_t middle = halve(first, last, static_cast<int>(axis), (box.min()[axis] + box.max()[axis]) / 2.0f);
  const float lower_end = box_of(first, middle).max()[axis], upper_begin = box_of(middle, last).min()[axis];
  const std::uint32_t lower = add_node(first, middle), upper = add_node(middle, last);
  nodes_[index] = {first, last, static_cast<int>(axis), lower_end, upper_begin, lower, upper};
  return index;
}

std::uint32_t NearestNeighbors::halve(std::uint32_t first, std::uint32_t last, int axis, float cut) {
  const auto begin = order_.begin() + first, end = order_.begin() + last;
  const auto on_cut = std::partition(begin, end, [&](std::uint32_t i) { return points_[i][axis] < cut; });
  const auto above = std::partition(on_cut, end, [&](std::uint32_t i) { return points_[i][axis] <= cut; });
  // Points on the cut go to either side.
  const auto middle = std::clamp(begin + (last - first) / 2, on_cut, above);
  return static_cast<std::uint32_t>(middle - order_.begin());
}

std::vector<std::uint32_t> NearestNeighbors::find(const cloud::Point& query, std::size_t count) const {
  if (count == 0) return {};
  Search found{.query = query, .count = count, .nearest = {}};
  search(nodes_.front(), found);
  std::vector<std::uint32_t> points;
  for (const Search::Candidate& candidate : found.nearest) points.push_back(candidate.point);
  return points;
}

void NearestNeighbors::search(const Node& node, Search& found) const {
  if (node.lower == 0) {
    for (std::uint32_t k = node.first; k < node.last; ++k) {
      const cloud::Point d = points_[order_[k]] - found.query;
      found.add({d.x() * d.x() + d.y() * d.y() + d.z() * d.z(), order_[k]});
    }
    return;
  }
  const float from_lower = found.query[node.axis] - node.lower_end;
  const float from_upper = found.query[node.axis] - node.upper_begin;
  const bool is_lower_nearer = from_lower + from_upper < 0.0f;
  search(nodes_[is_lower_nearer ? node.lower : node.upper], found);
  const float gap = is_lower_nearer ? from_upper : from_lower;
  if (gap * gap < found.worst()) search(nodes_[is_lower_nearer ? node.upper : node.lower], found);
}

}  // namespace tubebin::modeling
