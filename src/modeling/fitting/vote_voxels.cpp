#include "modeling/fitting/vote_voxels.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "modeling/parallel.hpp"

namespace tubebin::modeling {
namespace {

/// Where the search for a voxel begins. Voxels of a block of 2 x 2 x 4 are neighbours in the table, too, a cache line.
std::size_t first_slot(std::int32_t x, std::int32_t y, std::int32_t z) {
  // Teschner et al. 2003, "Optimized Spatial Hashing for Collision Detection of Deformable Objects", with the bits
  // mixed down since the table takes the lowest.
  std::uint64_t h = static_cast<std::uint32_t>(x >> 1) * 73856093ULL ^
                    static_cast<std::uint32_t>(y >> 1) * 19349663ULL ^ static_cast<std::uint32_t>(z >> 2) * 83492791ULL;
  h ^= h >> 15;
  return static_cast<std::size_t>(h << 4 | (x & 1) << 3 | (y & 1) << 2 | (z & 3));
}

}  // namespace

VoteVoxels::VoteVoxels(std::span<const cloud::Point> votes, double voxel, std::size_t least_votes) {
  table_.assign(std::bit_ceil(2 * votes.size() + 2), kNone);
  voxel_of_vote_.reserve(votes.size());
  const auto inverse = static_cast<float>(1.0 / voxel);
  std::uint32_t index = kNone;
  for (const cloud::Point& vote : votes) {
    const Key key{static_cast<std::int32_t>(std::floor(vote.x() * inverse)),
                  static_cast<std::int32_t>(std::floor(vote.y() * inverse)),
                  static_cast<std::int32_t>(std::floor(vote.z() * inverse))};
    // Votes that follow each other mostly share a voxel.
    if (index == kNone || !(keys_[index] == key)) index = find_or_add(key);
    ++counts_[index];
    means_[index] += vote;
    voxel_of_vote_.push_back(index);
  }

  std::vector<std::uint32_t> kept(keys_.size(), kNone);
  std::uint32_t size = 0;
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    if (counts_[i] < least_votes) continue;
    kept[i] = size;
    keys_[size] = keys_[i];
    means_[size] = means_[i] / static_cast<float>(counts_[i]);
    counts_[size++] = counts_[i];
  }
  keys_.resize(size);
  means_.resize(size);
  counts_.resize(size);
  for (std::uint32_t& voxel_of : voxel_of_vote_) voxel_of = kept[voxel_of];
  // Taken out of an open-addressing table, a key would break the chains of others: build it anew.
  table_.assign(std::bit_ceil(2 * std::size_t{size} + 2), kNone);
  for (std::uint32_t i = 0; i < size; ++i) table_[slot_of(keys_[i])] = i;
}

std::size_t VoteVoxels::slot_of(const Key& key) const {
  std::size_t slot = first_slot(key.x, key.y, key.z) & (table_.size() - 1);
  while (table_[slot] != kNone && !(keys_[table_[slot]] == key)) slot = (slot + 1) & (table_.size() - 1);
  return slot;
}

std::uint32_t VoteVoxels::find_or_add(const Key& key) {
  std::uint32_t& index = table_[slot_of(key)];
  if (index == kNone) {
    index = static_cast<std::uint32_t>(keys_.size());
    keys_.push_back(key);
    counts_.push_back(0);
    means_.push_back(cloud::Point::Zero());
  }
  return index;
}

std::uint32_t VoteVoxels::find(const Key& key) const { return table_[slot_of(key)]; }

std::vector<std::pair<std::uint32_t, std::uint32_t>> VoteVoxels::links(double link) const {
  constexpr std::uint32_t kAtOnce = 4096;
  const auto count = static_cast<std::uint32_t>(keys_.size());
  const auto squared = static_cast<float>(link * link);
  return gather_in_parallel((count + kAtOnce - 1) / kAtOnce, [&](std::size_t part) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    const std::uint32_t first = static_cast<std::uint32_t>(part) * kAtOnce;
    for (std::uint32_t i = first; i < std::min(first + kAtOnce, count); ++i)
      for (int offset = 14; offset < 27; ++offset) {  // half of the 3 x 3 x 3 cube about cell 13
        const std::uint32_t j =
            find({keys_[i].x + offset / 9 - 1, keys_[i].y + offset / 3 % 3 - 1, keys_[i].z + offset % 3 - 1});
        if (j != kNone && (means_[i] - means_[j]).squaredNorm() <= squared) pairs.emplace_back(i, j);
      }
    return pairs;
  });
}

double VoteVoxels::spread(std::uint32_t voxel) const {
  cloud::Point sum = cloud::Point::Zero();
  Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
  float count = 0.0f;
  for (int cell = 0; cell < 27; ++cell) {
    const auto& [x, y, z] = keys_[voxel];
    const std::uint32_t other = find({x + cell / 9 - 1, y + cell / 3 % 3 - 1, z + cell % 3 - 1});
    if (other == kNone) continue;
    const auto weight = static_cast<float>(counts_[other]);
    const cloud::Point offset = means_[other] - means_[voxel];
    count += weight, sum += weight * offset, squares += weight * offset * offset.transpose();
  }
  const cloud::Point mean = sum / count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver(squares / count - mean * mean.transpose(),
                                                              Eigen::EigenvaluesOnly);
  return solver.eigenvalues()(1) / std::max(solver.eigenvalues()(2), 1e-12f);
}

std::vector<std::uint32_t> connected_components(std::size_t count,
                                                std::span<const std::pair<std::uint32_t, std::uint32_t>> links) {
  std::vector<std::uint32_t> parent(count);
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const auto& [a, b] : links) {
    const std::uint32_t ra = root(a), rb = root(b);
    parent[std::max(ra, rb)] = std::min(ra, rb);
  }
  std::vector<std::uint32_t> component(count);
  std::uint32_t components = 0;
  for (std::uint32_t i = 0; i < count; ++i) component[i] = root(i) == i ? components++ : component[root(i)];
  return component;
}

}  // namespace tubebin::modeling
