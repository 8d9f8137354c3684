#include "dataset/pile.hpp"

#include <algorithm>

#include "dataset/randomization.hpp"
#include "dataset/stage_clock.hpp"

namespace tubebin::dataset {
namespace {

/// Most tubes of one pile that are lifted, one instead of the other, until the rest comes to rest.
constexpr int kTriesOfALift = 3;

/// Indices of the tubes with the fewest above: in a deep pile of bent tubes, hardly one has none.
std::vector<std::size_t> liftable_tubes(const std::vector<scene::PlacedTube>& tubes) {
  std::vector<int> counts(tubes.size(), 0);
  for (const scene::Above& pair : scene::find_above(tubes)) ++counts[pair.lower - 1];
  const int fewest = std::ranges::min(counts);
  std::vector<std::size_t> liftable;
  for (std::size_t i = 0; i < tubes.size(); ++i)
    if (counts[i] == fewest) liftable.push_back(i);
  return liftable;
}

/// Takes out of `liftable` the tube that the rule lifts next.
std::size_t take_next(std::vector<std::size_t>& liftable, const physics::DropResult& pile, LiftRule rule,
                      Random& random) {
  auto next = liftable.begin();
  if (rule == LiftRule::random) {
    next += random.integer(0, static_cast<int>(liftable.size()) - 1);
  } else {
    std::vector<double> heights;
    for (const std::size_t i : liftable) heights.push_back((pile.tubes[i].world_from_tube * pile.masses[i].center).z());
    next += std::ranges::max_element(heights) - heights.begin();
  }
  const std::size_t tube = *next;
  liftable.erase(next);
  return tube;
}

Pile to_pile(physics::DropResult result, std::uint64_t seed) {
  return {.seed = seed, .rest = std::move(result), .surroundings = {}, .lift = std::nullopt, .seconds = {}};
}

Piles failed_piles(const physics::DropResult& result, const std::string& where) {
  return {.failure = to_string(result.failure),
          .failure_detail = where + result.detail,
          .physics = result.figures,
          .piles = {}};
}

/// Nothing of what stands around is part of the simulation, so no tube may be where it stands.
Piles crowded_piles(const physics::DropFigures& figures, const std::string& detail) {
  return {.failure = "crowded", .failure_detail = detail, .physics = figures, .piles = {}};
}

scene::Lift to_lift(const Pile& before, std::size_t lifted, const physics::LiftResult& result) {
  scene::Lift lift{.lifted = static_cast<std::uint32_t>(lifted + 1),
                   .force = result.force,
                   .given_up = {},
                   .dragged = {},
                   .moved = {}};
  for (const std::size_t i : result.dragged) lift.dragged.push_back(static_cast<std::uint32_t>(i + 1));
  lift.moved = scene::find_moved(scene::without(before.rest.tubes, lift.lifted), result.rest.tubes);
  return lift;
}

/// Of one lift: the pile that it leaves, alone.
Piles lift_one(const DatasetConfig& config, const Pile& before, std::size_t tube, std::uint64_t physics_seed) {
  physics::LiftResult lift =
      physics::lift_tube(before.rest, tube, config.bin, config.physics, config.sequence.lift, physics_seed);
  if (lift.rest.failure != physics::DropFailure::none) return failed_piles(lift.rest, "");
  if (before.surroundings) {
    const std::string touching = scene::find_touching_tube(*before.surroundings, config.bin, lift.rest.tubes);
    if (!touching.empty()) return crowded_piles(lift.rest.figures, touching);
  }
  const scene::Lift record = to_lift(before, tube, lift);
  Pile after = to_pile(std::move(lift.rest), 0);
  after.surroundings = before.surroundings;
  after.lift = record;
  return {.failure = {}, .failure_detail = {}, .physics = {}, .piles = {std::move(after)}};
}

/// Lifts the tube that the rule chooses, or, where the others don't come to rest without it, the next: one that tips a
/// pile over need not cost the lifts before it.
Piles lift_next(const DatasetConfig& config, const Pile& before, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::size_t> liftable = liftable_tubes(before.rest.tubes);
  std::vector<std::uint32_t> given_up;
  while (true) {
    const std::size_t tube = take_next(liftable, before.rest, config.sequence.rule, random);
    Piles left = lift_one(config, before, tube, random.bits());
    if (left.failure.empty()) {
      left.piles.front().seed = seed;
      left.piles.front().lift->given_up = given_up;
      return left;
    }
    given_up.push_back(static_cast<std::uint32_t>(tube + 1));
    if (given_up.size() == kTriesOfALift || liftable.empty()) return left;
  }
}

}  // namespace

scene::PlacedSurroundings draw_surroundings(const DatasetConfig& config, std::uint64_t seed,
                                            const std::vector<scene::PlacedTube>& tubes) {
  constexpr std::uint64_t kStream = 0x7375'7272'6F75'6E64;
  Random random(derive_seed({seed, kStream}));
  return scene::place_surroundings(config.surroundings, config.bin, tubes, config.all_scanners(), random);
}

scene::Scene scene_of(const DatasetConfig& config, const Pile& pile) {
  const std::vector<scene::Scanner> scanners = config.all_scanners();
  return {.bin = config.bin,
          .scanner = scanners.front(),
          .tubes = pile.rest.tubes,
          .further_scanners = {scanners.begin() + 1, scanners.end()},
          .surroundings = pile.surroundings};
}

Piles make_piles(const DatasetConfig& undrawn, const SceneId& id, int attempt, int lifts) {
  Piles result;
  std::map<std::string, double> seconds;
  StageClock clock(seconds);
  const std::uint64_t seed = attempt_seed(undrawn, id, attempt);
  Random random(seed);
  result.drawn = draw_scene_numbers(undrawn, seed);
  result.config = with_numbers(undrawn, result.drawn);
  const DatasetConfig& config = result.config;
  std::vector<tube::Tube> tubes;
  try {
    check_drawn(config);
    tubes = make_tubes(config, id.tubes, seed, random);
  } catch (const ConfigError& error) {
    return {.failure = "contradiction", .failure_detail = error.what(), .physics = {}, .piles = {}};
  }
  clock.end_stage("build");
  physics::DropResult drop = physics::drop_tubes(tubes, config.bin, config.physics, random.bits());
  clock.end_stage("drop");
  if (drop.failure != physics::DropFailure::none) return failed_piles(drop, "");
  result.physics = drop.figures;
  result.piles.push_back(to_pile(std::move(drop), seed));
  result.piles.back().seconds = seconds;
  const scene::PlacedSurroundings around = draw_surroundings(config, seed, result.piles.back().rest.tubes);
  if (!around.problem.empty()) return crowded_piles(result.physics, around.problem);
  result.piles.back().surroundings = around.surroundings;

  for (int step = 1; step <= lifts; ++step) {
    Piles left = lift_next(config, result.piles.back(), derive_seed({seed, static_cast<std::uint64_t>(step)}));
    if (!left.failure.empty()) {
      left.failure_detail = fmt::format("after lift {}: {}", step, left.failure_detail);
      return left;
    }
    seconds.clear();
    clock.end_stage("lift");
    result.piles.push_back(std::move(left.piles.front()));
    result.piles.back().seconds = seconds;
  }
  return result;
}

}  // namespace tubebin::dataset
