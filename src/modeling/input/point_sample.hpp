#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "tubebin/cloud/cloud.hpp"

namespace tubebin::modeling {

/// The points at the indices, in their order.
inline std::vector<cloud::Point> points_at(std::span<const cloud::Point> points,
                                           std::span<const std::uint32_t> indices) {
  std::vector<cloud::Point> selected;
  selected.reserve(indices.size());
  for (const std::uint32_t i : indices) selected.push_back(points[i]);
  return selected;
}

/// The same in double precision.
inline std::vector<Vec3> positions_at(std::span<const cloud::Point> points, std::span<const std::uint32_t> indices) {
  std::vector<Vec3> positions;
  positions.reserve(indices.size());
  for (const std::uint32_t i : indices) positions.push_back(points[i].cast<double>());
  return positions;
}

/// At most `most` of them, spread evenly.
template <typename Value>
std::vector<Value> some_of(std::span<const Value> all, std::size_t most) {
  std::vector<Value> some;
  for (std::size_t k = 0; k < all.size(); k += all.size() / most + 1) some.push_back(all[k]);
  return some;
}

/// Of at most about `size` points of a scan, spread evenly over it, those that are finite.
inline std::vector<Vec3> sample_of(std::span<const cloud::Point> points, std::size_t size) {
  std::vector<Vec3> sample;
  for (std::size_t i = 0; i < points.size(); i += points.size() / size + 1)
    if (cloud::is_finite(points[i])) sample.push_back(points[i].cast<double>());
  return sample;
}

/// The mean of the places that `place` takes from each.
template <typename Samples, typename Place = std::identity>
Vec3 middle_of(const Samples& samples, const Place& place = {}) {
  Vec3 sum = Vec3::Zero();
  for (const auto& sample : samples) sum += std::invoke(place, sample);
  return sum / static_cast<double>(samples.size());
}

}  // namespace tubebin::modeling
