#include "evaluation/position_index.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace tubebin::evaluation {
namespace {

std::uint64_t combined_hash(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
  std::uint64_t hash = a * 0x9e3779b97f4a7c15ULL;
  hash = (hash ^ (hash >> 29) ^ b) * 0xbf58476d1ce4e5b9ULL;
  hash = (hash ^ (hash >> 32) ^ c) * 0x94d049bb133111ebULL;
  return hash ^ (hash >> 31);
}

std::uint64_t position_hash(const cloud::Point& point) {
  // Adding zero turns -0 into 0, which compares equal to it.
  const auto bits = [](float value) { return std::uint64_t{std::bit_cast<std::uint32_t>(value + 0.0F)}; };
  return combined_hash(bits(point.x()), bits(point.y()), bits(point.z()));
}

/// Points chained by hash, each chain in the points' order. A point that is taken leaves its chain, so a
/// thousand points at one position cost no more than a thousand at as many positions.
class PointChains {
 public:
  explicit PointChains(std::size_t capacity)
      : heads_(std::bit_ceil(std::max<std::size_t>(2 * capacity, 16)), kNoPoint), next_(capacity, kNoPoint) {}

  /// Points are to be added from the last to the first.
  void add(std::uint64_t hash, std::uint32_t point) {
    std::uint32_t& head = head_of(hash);
    next_[point] = head;
    head = point;
  }

  template <typename Predicate>
  std::uint32_t take_first(std::uint64_t hash, Predicate is_wanted) {
    for (std::uint32_t* link = &head_of(hash); *link != kNoPoint; link = &next_[*link]) {
      const std::uint32_t point = *link;
      if (!is_wanted(point)) continue;
      *link = next_[point];
      return point;
    }
    return kNoPoint;
  }

 private:
  std::uint32_t& head_of(std::uint64_t hash) { return heads_[hash & (heads_.size() - 1)]; }

  std::vector<std::uint32_t> heads_;
  std::vector<std::uint32_t> next_;
};

bool in_the_same_order(std::span<const cloud::Point> a, std::span<const cloud::Point> b) {
  return a.size() == b.size() &&
         std::equal(a.begin(), a.end(), b.begin(), [](const cloud::Point& p, const cloud::Point& q) {
           return p == q || (!cloud::is_finite(p) && !cloud::is_finite(q));
         });
}

std::vector<std::uint32_t> identity(std::span<const cloud::Point> points) {
  std::vector<std::uint32_t> result(points.size(), kNoPoint);
  for (std::uint32_t i = 0; i < points.size(); ++i)
    if (cloud::is_finite(points[i])) result[i] = i;
  return result;
}

void match_equal(std::span<const cloud::Point> queries, std::span<const cloud::Point> reference,
                 std::vector<std::uint32_t>& result) {
  PointChains chains(reference.size());
  for (std::size_t i = reference.size(); i-- > 0;)
    if (cloud::is_finite(reference[i])) chains.add(position_hash(reference[i]), static_cast<std::uint32_t>(i));
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const cloud::Point& query = queries[i];
    if (!cloud::is_finite(query)) continue;
    result[i] = chains.take_first(position_hash(query), [&](std::uint32_t p) { return reference[p] == query; });
  }
}

/// Cells are twice the tolerance wide, so what is near a query lies in at most two cells in each direction.
void match_near(std::span<const cloud::Point> queries, std::span<const cloud::Point> reference, float tolerance,
                std::vector<std::uint32_t>& result) {
  const double cell_size = 2.0 * static_cast<double>(tolerance);
  const auto cell = [&](double coordinate) {
    return static_cast<std::uint64_t>(
        static_cast<std::int64_t>(std::floor(std::clamp(coordinate / cell_size, -1e15, 1e15))));
  };
  std::vector<char> taken(reference.size(), 0);
  for (const std::uint32_t point : result)
    if (point != kNoPoint) taken[point] = 1;

  PointChains chains(reference.size());
  for (std::size_t i = reference.size(); i-- > 0;) {
    const cloud::Point& p = reference[i];
    if (!taken[i] && cloud::is_finite(p))
      chains.add(combined_hash(cell(p.x()), cell(p.y()), cell(p.z())), static_cast<std::uint32_t>(i));
  }
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const cloud::Point& query = queries[i];
    if (result[i] != kNoPoint || !cloud::is_finite(query)) continue;
    const auto is_near = [&](std::uint32_t p) { return (reference[p] - query).cwiseAbs().maxCoeff() <= tolerance; };
    for (int corner = 0; corner < 8 && result[i] == kNoPoint; ++corner) {
      const auto side = [&](int axis) {
        const double offset = (corner >> axis) & 1 ? static_cast<double>(tolerance) : -static_cast<double>(tolerance);
        return cell(static_cast<double>(query[axis]) + offset);
      };
      result[i] = chains.take_first(combined_hash(side(0), side(1), side(2)), is_near);
    }
  }
}

}  // namespace

std::vector<std::uint32_t> corresponding_points(std::span<const cloud::Point> queries,
                                                std::span<const cloud::Point> reference, float tolerance) {
  if (in_the_same_order(queries, reference)) return identity(queries);
  std::vector<std::uint32_t> result(queries.size(), kNoPoint);
  match_equal(queries, reference, result);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (result[i] != kNoPoint || !cloud::is_finite(queries[i])) continue;
    match_near(queries, reference, tolerance, result);
    break;
  }
  return result;
}

}  // namespace tubebin::evaluation
