#include "modeling/fitting/vote_graph.hpp"

#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "modeling/fitting/vote_voxels.hpp"
#include "modeling/parallel.hpp"

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

VoteGraph::VoteGraph(const FilteredCloud& cloud, const Segment& segment, double radius) : voxel_(radius / 3.0) {
  const VoteVoxels voxels(votes_of(cloud, segment, radius), voxel_, 1);
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    means_.push_back(voxels.mean(i));
    counts_.push_back(voxels.count(i));
  }
  for (std::size_t k = 0; k < segment.size(); ++k) voxel_of_.push_back(voxels.voxel_of(k));
  const auto pairs = voxels.links(radius / 2.0);
  first_link_.resize(size() + 1, 0);
  for (const auto& [a, b] : pairs) ++first_link_[a + 1], ++first_link_[b + 1];
  std::partial_sum(first_link_.begin(), first_link_.end(), first_link_.begin());
  links_.resize(2 * pairs.size());
  std::vector<std::uint32_t> next = first_link_;
  for (const auto& [a, b] : pairs) links_[next[a]++] = b, links_[next[b]++] = a;
  find_end();
}

std::vector<VoteGraph> VoteGraph::divided(std::span<const std::uint32_t> part_of_voxel, std::size_t parts) const {
  std::vector<std::uint32_t> place(size());  // of each voxel in its part
  std::vector<std::vector<std::uint32_t>> voxels(parts), points(parts);
  for (std::uint32_t i = 0; i < size(); ++i) {
    place[i] = static_cast<std::uint32_t>(voxels[part_of_voxel[i]].size());
    voxels[part_of_voxel[i]].push_back(i);
  }
  for (const std::uint32_t i : voxel_of_) points[part_of_voxel[i]].push_back(place[i]);
  return map_in_parallel(parts, [&](std::size_t part) {
    VoteGraph graph;
    graph.voxel_ = voxel_;
    graph.voxel_of_ = std::move(points[part]);
    for (const std::uint32_t i : voxels[part]) {
      graph.means_.push_back(mean(i));
      graph.counts_.push_back(count(i));
      for (const std::uint32_t j : linked(i))
        if (part_of_voxel[j] == part) graph.links_.push_back(place[j]);
      graph.first_link_.push_back(static_cast<std::uint32_t>(graph.links_.size()));
    }
    graph.find_end();
    return graph;
  });
}

void VoteGraph::find_end() {
  // The voxel of most votes is on the line for sure, where any other may be a stray that nothing links to.
  std::uint32_t middle = 0;
  for (std::uint32_t i = 1; i < size(); ++i)
    if (count(i) > count(middle)) middle = i;
  end_ = farthest(distances_from({&middle, 1}), middle);
  distances_from_end_ = distances_from({&end_, 1});
}

std::vector<double> VoteGraph::distances_from(std::span<const std::uint32_t> sources) const {
  std::vector<double> distance(size(), std::numeric_limits<double>::infinity());
  std::vector<std::vector<std::pair<double, std::uint32_t>>> queue(1);  // by distance, so many voxels' widths far
  for (const std::uint32_t source : sources) {
    distance[source] = 0.0;
    queue.front().emplace_back(0.0, source);
  }
  for (std::size_t far = 0; far < queue.size(); ++far)
    for (std::size_t k = 0; k < queue[far].size(); ++k) {
      const auto [d, i] = queue[far][k];
      if (d > distance[i]) continue;
      for (const std::uint32_t j : linked(i)) {
        const double through = d + double((mean(i) - mean(j)).norm());
        if (through >= distance[j]) continue;
        distance[j] = through;
        const auto place = static_cast<std::size_t>(through / voxel_);
        if (place >= queue.size()) queue.resize(place + 1);
        queue[place].emplace_back(through, j);
      }
    }
  return distance;
}

std::vector<std::uint32_t> VoteGraph::longest_way() const {
  const std::vector<double>& distance = distances_from_end_;
  std::vector<std::uint32_t> way = {farthest(distance, end_)};
  while (way.back() != end_) {
    std::uint32_t before = way.back();
    for (const std::uint32_t j : linked(way.back()))
      if (distance[j] < distance[before]) before = j;
    way.push_back(before);
  }
  return way;
}

}  // namespace tubebin::modeling
