#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "modeling/joining/cover_margins.hpp"
#include "modeling/labeling.hpp"
#include "tubebin/core/random.hpp"
#include "tubebin/modeling/filtering.hpp"

namespace tubebin::modeling {
namespace {

using Exclusions = std::vector<std::vector<std::uint32_t>>;  // of each place

/// Gives each candidate from `first` on a place of its own and lets a third of their pairs exclude each other.
Exclusions exclude_at_random(Random& random, std::vector<PathCandidate>& candidates, std::uint32_t first) {
  Exclusions excluded_by(candidates.size() - first);
  for (std::uint32_t a = first; a < candidates.size(); ++a) {
    candidates[a].places = {a - first};
    for (std::uint32_t b = first; b < a; ++b) {
      if (random.integer(0, 2) > 0) continue;
      excluded_by[a - first].push_back(b - first);
      excluded_by[b - first].push_back(a - first);
    }
  }
  return excluded_by;
}

bool any_excluded(const std::vector<PathCandidate>& candidates, const Exclusions& excluded_by,
                  const std::vector<std::uint32_t>& chosen) {
  std::set<std::uint32_t> taken;
  for (const std::uint32_t c : chosen) taken.insert(candidates[c].places.begin(), candidates[c].places.end());
  return std::any_of(taken.begin(), taken.end(), [&](std::uint32_t place) {
    const auto& excluded = excluded_by[place];
    return std::any_of(excluded.begin(), excluded.end(), [&](std::uint32_t other) { return taken.contains(other); });
  });
}

/// The cheapest choice of candidates that holds each item once, by trying all.
double cheapest_by_trying_all(std::size_t item_count, const std::vector<PathCandidate>& candidates,
                              const Exclusions& excluded_by) {
  double cheapest = 1e18;
  for (std::uint32_t chosen = 0; chosen < (1u << candidates.size()); ++chosen) {
    std::vector<int> held(item_count, 0);
    std::vector<std::uint32_t> indices;
    double cost = 0.0;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (!(chosen >> i & 1u)) continue;
      indices.push_back(static_cast<std::uint32_t>(i));
      cost += candidates[i].cost;
      for (const std::uint32_t item : candidates[i].items) ++held[item];
    }
    if (cost < cheapest && std::all_of(held.begin(), held.end(), [](int n) { return n == 1; }) &&
        !any_excluded(candidates, excluded_by, indices))
      cheapest = std::min(cheapest, cost);
  }
  return cheapest;
}

/// Each item alone, and paths of two and three at random.
std::vector<PathCandidate> random_candidates(Random& random, std::uint32_t items) {
  std::vector<PathCandidate> candidates(items + 8);
  for (std::uint32_t i = 0; i < items; ++i) {
    candidates[i].items = {i};
    candidates[i].cost = random.uniform(0.5, 2.0);
  }
  for (std::uint32_t c = items; c < candidates.size(); ++c) {
    std::set<std::uint32_t> chosen;
    const int length = random.integer(2, 3);
    while (static_cast<int>(chosen.size()) < std::min<int>(length, static_cast<int>(items)))
      chosen.insert(static_cast<std::uint32_t>(random.integer(0, static_cast<int>(items) - 1)));
    candidates[c].items.assign(chosen.begin(), chosen.end());
    candidates[c].cost = random.uniform(0.0, 3.0);
  }
  return candidates;
}

TEST(PathCover, IsTheCheapestOfAll) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const std::uint32_t items = static_cast<std::uint32_t>(random.integer(2, 6));
    std::vector<PathCandidate> candidates = random_candidates(random, items);
    const Exclusions excluded_by = exclude_at_random(random, candidates, items);
    const auto cover = cheapest_path_cover(items, candidates, excluded_by, 100000).chosen;
    double cost = 0.0;
    std::vector<int> held(items, 0);
    for (const std::uint32_t index : cover) {
      cost += candidates[index].cost;
      for (const std::uint32_t item : candidates[index].items) ++held[item];
    }
    EXPECT_TRUE(std::all_of(held.begin(), held.end(), [](int n) { return n == 1; }));
    EXPECT_FALSE(any_excluded(candidates, excluded_by, cover));
    EXPECT_NEAR(cost, cheapest_by_trying_all(items, candidates, excluded_by), 1e-9);
  }
}

TEST(PathCover, KeepsApartWhatTakesUpOnePlace) {
  const std::vector<PathCandidate> candidates = {{{0}, 1.0},         {{1}, 1.0},         {{2}, 1.0},   {{3}, 1.0},
                                                 {{0, 1}, 0.1, {0}}, {{2, 3}, 0.2, {1}}, {{1, 2}, 9.0}};
  const auto cover = cheapest_path_cover(4, candidates, Exclusions{{1}, {0}}, 1000).chosen;
  EXPECT_EQ(std::set<std::uint32_t>(cover.begin(), cover.end()), (std::set<std::uint32_t>{2, 3, 4}));
}

/// The margin to the cheapest cover without the candidates that are ruled out, by trying all.
template <typename IsRuledOut>
double margin_by_trying_all(std::size_t items, std::vector<PathCandidate> candidates, const Exclusions& excluded_by,
                            const IsRuledOut& is_ruled_out) {
  const double cheapest = cheapest_by_trying_all(items, candidates, excluded_by);
  std::erase_if(candidates, is_ruled_out);
  return std::min(cheapest_by_trying_all(items, candidates, excluded_by) - cheapest, CoverMargins::kMost);
}

TEST(CoverMargins, AreToTheCheapestOtherCover) {
  Random random(2);
  std::size_t pairs = 0;
  for (int trial = 0; trial < 80; ++trial) {
    const std::uint32_t items = static_cast<std::uint32_t>(random.integer(3, 6));
    std::vector<PathCandidate> candidates = random_candidates(random, items);
    const bool has_places = trial % 2 == 0;
    const Exclusions excluded_by = has_places ? exclude_at_random(random, candidates, items) : Exclusions{};
    const PathCover cover = cheapest_path_cover(items, candidates, excluded_by, 100000);
    const CoverMargins margins(cover, candidates, excluded_by);
    const auto check = [&](double margin, const auto& is_ruled_out) {
      const double least = margin_by_trying_all(items, candidates, excluded_by, is_ruled_out);
      EXPECT_GT(margin, least - 1e-9);
      // Places that become free help no others.
      EXPECT_LT(margin, has_places ? CoverMargins::kMost + 1e-9 : least + 1e-9);
    };
    for (const std::uint32_t c : cover.chosen) {
      const PathNumbers own = candidates[c].items;
      const double cost = candidates[c].cost;
      check(margins.of_path(c), [&](const auto& path) { return path.cost == cost && path.items == own; });
      if (own.size() < 2) continue;
      ++pairs;
      const auto holds = [](const PathCandidate& path, std::uint32_t item) {
        return std::find(path.items.begin(), path.items.end(), item) != path.items.end();
      };
      check(margins.of_pair(own[0], own[1]),
            [&](const auto& path) { return holds(path, own[0]) && holds(path, own[1]); });
    }
  }
  EXPECT_GT(pairs, 30u);
}

TEST(Labeling, DistancesMatchSampledSurfaces) {
  const std::vector<Vec3> nodes = {Vec3(0, 0, 0), Vec3(0.1, 0, 0), Vec3(0.15, 0.06, 0.02)};
  const TubeSurface surface{nodes, 0.0125};
  std::vector<Vec3> samples;
  for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
    const Vec3 axis = (nodes[i + 1] - nodes[i]).normalized();
    const Vec3 u = axis.unitOrthogonal();
    const Vec3 v = axis.cross(u);
    for (int k = 0; k <= 200; ++k)
      for (int a = 0; a < 120; ++a) {
        const double angle = 2 * std::numbers::pi * a / 120;
        const Vec3 ring = std::cos(angle) * u + std::sin(angle) * v;
        samples.push_back(nodes[i] + (nodes[i + 1] - nodes[i]) * k / 200.0 + 0.0125 * ring);
        if (k <= 20) samples.push_back((i == 0 ? nodes[0] : nodes[2]) + 0.0125 * k / 20.0 * ring);
      }
  }
  Random random(2);
  for (int trial = 0; trial < 300; ++trial) {
    const Vec3 p(random.uniform(-0.03, 0.18), random.uniform(-0.04, 0.1), random.uniform(-0.04, 0.06));
    const double distance = distances_to_surface(surface, std::span(&p, 1)).front();
    if (distance < 0.0 || (p - nodes[1]).norm() < 0.045) continue;  // inside, or nearest to the unsampled joint
    double nearest = 1.0;
    for (const Vec3& sample : samples) nearest = std::min(nearest, (sample - p).norm());
    EXPECT_NEAR(distance, nearest, 0.0006);
  }
}

TEST(Labeling, TakesTheNearestSurfaceWithinReach) {
  const std::vector<Vec3> low = {Vec3(-0.1, 0, 0.0125), Vec3(0.1, 0, 0.0125)};
  const std::vector<Vec3> high = {Vec3(0, -0.1, 0.0375), Vec3(0, 0.1, 0.0375)};
  const std::vector<cloud::Point> points = {cloud::Point(0.05f, 0.0f, 0.0253f), cloud::Point(0.0f, 0.05f, 0.0505f),
                                            cloud::Point(0.05f, 0.05f, 0.0f)};
  const auto nearest =
      nearest_surfaces(points, {{low, 0.0125}, {high, 0.0125}}, {.seen = 0.5, .end = 0.5, .bridged = 0.5});
  EXPECT_EQ(nearest[0].surface, 0u);
  EXPECT_EQ(nearest[1].surface, 1u);
  EXPECT_EQ(nearest[2].surface, NearestSurface::kNone);
}

TEST(Filtering, DownsamplingIsExactSeededAndBlindToTheOrder) {
  Random random(3);
  std::vector<cloud::Point> points;
  for (int i = 0; i < 1000; ++i)
    points.emplace_back(static_cast<float>(random.uniform(0, 1)), static_cast<float>(random.uniform(0, 1)), 0.0f);
  std::vector<std::uint32_t> indices(points.size());
  for (std::uint32_t i = 0; i < indices.size(); ++i) indices[i] = i;
  const auto kept = downsample(points, indices, 0.3, 4);
  EXPECT_EQ(kept.size(), 300u);
  EXPECT_EQ(downsample(points, indices, 0.3, 4), kept);
  EXPECT_NE(downsample(points, indices, 0.3, 5), kept);

  std::vector<cloud::Point> reversed(points.rbegin(), points.rend());
  std::set<float> xs;
  std::set<float> reversed_xs;
  for (const auto i : kept) xs.insert(points[i].x());
  for (const auto i : downsample(reversed, indices, 0.3, 4)) reversed_xs.insert(reversed[i].x());
  EXPECT_EQ(xs, reversed_xs);
}

TEST(Filtering, CropsFloorAndWalls) {
  const scene::Bin bin;
  const std::vector<cloud::Point> points = {cloud::Point(0, 0, 0),         cloud::Point(0, 0, 0.01f),
                                            cloud::Point(0.275f, 0, 0.1f), cloud::Point(0.2f, 0.1f, 0.1f),
                                            cloud::Point(NAN, 0, 0),       cloud::Point(0.27f, 0, 0.25f)};
  const ModelingInput input{.points = points, .world_from_sensor = scene::Scanner{}.world_from_scanner(), .bin = bin};
  EXPECT_EQ(crop_bin(input, {}), (std::vector<std::uint32_t>{1, 3, 5}));
}

}  // namespace
}  // namespace tubebin::modeling
