#include "modeling/fitting/vote_graph.hpp"

#include <cmath>
#include <limits>
#include <queue>

namespace tubebin::modeling {
namespace {

std::vector<cloud::Point> votes_of(const FilteredCloud& cloud, const Segment& segment, double radius) {
  std::vector<cloud::Point> votes;
  votes.reserve(segment.size());
  for (const std::uint32_t i : segment)
    votes.push_back(cloud.points[i] - static_cast<float>(radius) * cloud.normals[i]);
  return votes;
}

/// The reachable voxel that is farthest.
std::uint32_t farthest(const std::vector<double>& distance, std::uint32_t from) {
  std::uint32_t best = from;
  for (std::uint32_t i = 0; i < distance.size(); ++i)
    if (std::isfinite(distance[i]) && distance[i] > distance[best]) best = i;
  return best;
}

}  // namespace

VoteGraph::VoteGraph(const FilteredCloud& cloud, const Segment& segment, double radius)
    : voxels_(votes_of(cloud, segment, radius), radius / 3.0, 1), linked_(voxels_.size()) {
  for (const auto& [a, b] : voxels_.links(radius / 2.0)) {
    linked_[a].push_back(b);
    linked_[b].push_back(a);
  }
  // The voxel of most votes is on the line for sure, where any other may be a stray that nothing links to.
  std::uint32_t middle = 0;
  for (std::uint32_t i = 1; i < size(); ++i)
    if (count(i) > count(middle)) middle = i;
  end_ = farthest(distances_from({&middle, 1}), middle);
  distances_from_end_ = distances_from({&end_, 1});
}

std::vector<double> VoteGraph::distances_from(std::span<const std::uint32_t> sources) const {
  std::vector<double> distance(size(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const std::uint32_t source : sources) {
    distance[source] = 0.0;
    queue.emplace(0.0, source);
  }
  while (!queue.empty()) {
    const auto [d, i] = queue.top();
    queue.pop();
    if (d > distance[i]) continue;
    for (const std::uint32_t j : linked_[i]) {
      const double through = d + double((mean(i) - mean(j)).norm());
      if (through >= distance[j]) continue;
      distance[j] = through;
      queue.emplace(through, j);
    }
  }
  return distance;
}

std::vector<std::uint32_t> VoteGraph::longest_way() const {
  const std::vector<double>& distance = distances_from_end_;
  std::vector<std::uint32_t> way = {farthest(distance, end_)};
  while (way.back() != end_) {
    std::uint32_t before = way.back();
    for (const std::uint32_t j : linked_[way.back()])
      if (distance[j] < distance[before]) before = j;
    way.push_back(before);
  }
  return way;
}

}  // namespace tubebin::modeling
