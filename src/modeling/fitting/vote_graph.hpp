/// Ways through the centreline votes of one segment.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// Voxels of votes as the vertices of a graph: those whose mean votes are at most half a radius apart are linked.
class VoteGraph {
 public:
  VoteGraph() = default;
  /// All votes of the segment, since some alone may leave gaps wider than a link.
  VoteGraph(const FilteredCloud& cloud, const Segment& segment, double radius);
  /// The graphs of its parts: `part_of_voxel` numbers them from 0 to `parts` - 1. Each keeps the order of voxels and points, and is
  /// what its points alone would make.
  std::vector<VoteGraph> divided(std::span<const std::uint32_t> part_of_voxel, std::size_t parts) const;

  std::size_t size() const { return means_.size(); }
  const cloud::Point& mean(std::size_t voxel) const { return means_[voxel]; }
  std::size_t count(std::size_t voxel) const { return counts_[voxel]; }
  /// Voxel of the segment's point k.
  std::uint32_t voxel_of(std::size_t k) const { return voxel_of_[k]; }
  std::span<const std::uint32_t> linked(std::uint32_t voxel) const {
    return std::span(links_).subspan(first_link_[voxel], first_link_[voxel + 1] - first_link_[voxel]);
  }

  /// Length of the shortest way from each voxel to the nearest of `sources`, metres; infinite where there is none.
  std::vector<double> distances_from(std::span<const std::uint32_t> sources) const;
  /// One end of the longest way through the part that holds most votes: the farthest voxel from any is an end.
  std::uint32_t end() const { return end_; }
  const std::vector<double>& distances_from_end() const { return distances_from_end_; }
  /// The voxels along that way.
  std::vector<std::uint32_t> longest_way() const;

 private:
  void find_end();

  double voxel_ = 0.0;  ///< width, metres
  std::vector<cloud::Point> means_;
  std::vector<std::size_t> counts_;
  std::vector<std::uint32_t> voxel_of_;
  std::vector<std::uint32_t> links_;             ///< of all voxels, one after the other
  std::vector<std::uint32_t> first_link_ = {0};  ///< of each voxel, and the end
  std::uint32_t end_ = 0;
  std::vector<double> distances_from_end_;
};

}  // namespace tubebin::modeling
