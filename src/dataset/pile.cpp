#include "dataset/pile.hpp"

#include <algorithm>

#include "dataset/randomization.hpp"
#include "dataset/stage_clock.hpp"

namespace tubebin::dataset {
namespace {

/// Index of the tube that the rule lifts next.
std::size_t choose_tube(const std::vector<scene::PlacedTube>& tubes, LiftRule rule, Random& random) {
  const std::vector<scene::Above> above = scene::find_above(tubes);
  std::vector<std::size_t> free, all;
  for (std::size_t i = 0; i < tubes.size(); ++i) {
    all.push_back(i);
    if (std::ranges::none_of(above, [&](const scene::Above& pair) { return pair.lower == i + 1; })) free.push_back(i);
  }
  const std::vector<std::size_t>& choice = free.empty() ? all : free;
  if (rule == LiftRule::random)
    return choice[static_cast<std::size_t>(random.integer(0, static_cast<int>(choice.size()) - 1))];
  return std::ranges::max(choice, {}, [&](std::size_t i) {
    return (tubes[i].world_from_tube * tube::mass_properties(tubes[i].tube).center).z();
  });
}

Pile to_pile(physics::DropResult result, std::uint64_t seed) {
  return {.seed = seed,
          .tubes = std::move(result.tubes),
          .surroundings = {},
          .contacts = std::move(result.contacts),
          .physics = result.figures,
          .lift = std::nullopt,
          .seconds = {}};
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
  scene::Lift lift{.lifted = static_cast<std::uint32_t>(lifted + 1), .force = result.force, .dragged = {}, .moved = {}};
  for (const std::size_t i : result.dragged) lift.dragged.push_back(static_cast<std::uint32_t>(i + 1));
  lift.moved = scene::find_moved(scene::without(before.tubes, lift.lifted), result.rest.tubes);
  return lift;
}

}  // namespace

scene::PlacedSurroundings draw_surroundings(const DatasetConfig& config, std::uint64_t seed,
                                            const std::vector<scene::PlacedTube>& tubes) {
  constexpr std::uint64_t kStream = 0x7375'7272'6F75'6E64;
  Random random(derive_seed({seed, kStream}));
  return scene::place_surroundings(config.surroundings, config.bin, tubes, config.all_scanners(), random);
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
  const scene::PlacedSurroundings around = draw_surroundings(config, seed, result.piles.back().tubes);
  if (!around.problem.empty()) return crowded_piles(result.physics, around.problem);
  result.piles.back().surroundings = around.surroundings;

  for (int step = 1; step <= lifts; ++step) {
    const Pile& before = result.piles.back();
    const std::uint64_t step_seed = derive_seed({seed, static_cast<std::uint64_t>(step)});
    Random step_random(step_seed);
    const std::size_t lifted = choose_tube(before.tubes, config.sequence.rule, step_random);
    physics::LiftResult lift =
        physics::lift_tube(before.tubes, lifted, config.bin, config.physics, config.sequence.lift, step_random.bits());
    if (lift.rest.failure != physics::DropFailure::none)
      return failed_piles(lift.rest, fmt::format("after lift {}: ", step));
    const scene::Lift record = to_lift(before, lifted, lift);
    if (around.surroundings) {
      const std::string touching = scene::find_touching_tube(*around.surroundings, config.bin, lift.rest.tubes);
      if (!touching.empty()) return crowded_piles(lift.rest.figures, fmt::format("after lift {}: {}", step, touching));
    }
    seconds.clear();
    clock.end_stage("lift");
    result.piles.push_back(to_pile(std::move(lift.rest), step_seed));
    result.piles.back().surroundings = around.surroundings;
    result.piles.back().lift = record;
    result.piles.back().seconds = seconds;
  }
  return result;
}

}  // namespace tubebin::dataset
