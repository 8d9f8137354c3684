/// Centreline votes gathered in voxels, and which voxels are linked.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "tubebin/cloud/cloud.hpp"

namespace tubebin::modeling {

class VoteVoxels {
 public:
  /// Gathers the votes (metres) in cubes of edge `voxel`; cubes with fewer than `least_votes` are left out.
  VoteVoxels(std::span<const cloud::Point> votes, double voxel, std::size_t least_votes);

  static constexpr std::uint32_t kNone = UINT32_MAX;

  std::size_t size() const { return means_.size(); }
  const cloud::Point& mean(std::size_t voxel) const { return means_[voxel]; }
  std::size_t count(std::size_t voxel) const { return counts_[voxel]; }
  /// Voxel of a vote, kNone where it was left out.
  std::uint32_t voxel_of(std::size_t vote) const { return voxel_of_vote_[vote]; }
  /// Pairs of adjacent voxels (26-neighbourhood) whose mean votes are at most `link` metres apart.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links(double link) const;
  /// The second largest variance of the votes in the 3 x 3 x 3 voxels about one over the largest: near 0 on a line, near 1 on
  /// a sheet.
  double spread(std::uint32_t voxel) const;

 private:
  struct Key {
    std::int32_t x, y, z;
    friend bool operator==(const Key&, const Key&) = default;
  };
  /// Where in the table the key is, or would be.
  std::size_t slot_of(const Key& key) const;
  std::uint32_t find(const Key& key) const;
  std::uint32_t find_or_add(const Key& key);

  std::vector<cloud::Point> means_;
  std::vector<std::size_t> counts_;
  std::vector<Key> keys_;
  std::vector<std::uint32_t> table_;  ///< open addressing, voxel index or kNone
  std::vector<std::uint32_t> voxel_of_vote_;
};

/// Connected components of `count` vertices: the component of each, numbered from 0 by their first vertices.
std::vector<std::uint32_t> connected_components(std::size_t count,
                                                std::span<const std::pair<std::uint32_t, std::uint32_t>> links);

}  // namespace tubebin::modeling
