#include "tubebin/tube/tube_generator.hpp"

#include <numeric>

#include "tubebin/core/shuffle.hpp"

namespace tubebin::tube {
namespace {

Tube generate_tube(std::size_t number, std::size_t kind, TubeOptions options, const DrawOptions& draw_options,
                   Random& random) {
  const DrawnNumbers drawn = draw_options ? draw_options(number, kind, options) : DrawnNumbers{};
  Tube tube = options.shape->generate(options, random);
  tube.radius = options.radius;
  tube.wall_thickness = options.wall_thickness;
  tube.mass = options.mass;
  tube.drawn = drawn;
  return tube;
}

int total_count(const std::vector<TubeKind>& kinds) {
  return std::accumulate(kinds.begin(), kinds.end(), 0, [](int sum, const TubeKind& kind) { return sum + kind.count; });
}

double total_share(const std::vector<TubeKind>& kinds) {
  return std::accumulate(kinds.begin(), kinds.end(), 0.0,
                         [](double sum, const TubeKind& kind) { return sum + kind.share; });
}

const TubeKind* draw_by_share(const std::vector<TubeKind>& kinds, Random& random) {
  double left = random.uniform(0.0, total_share(kinds));
  const TubeKind* drawn = nullptr;
  for (const TubeKind& kind : kinds) {
    if (kind.share == 0.0) continue;
    drawn = &kind;
    if (left < kind.share) break;
    left -= kind.share;
  }
  return drawn;
}

}  // namespace

void describe(Fields& fields, TubeOptions& options) {
  options.shape.describe(fields);
  fields.number("radius", options.radius, {0.0005, 1.0}, "m", "outer radius r");
  options.shape->describe(fields, options);
  fields.number("wall_thickness", options.wall_thickness, {0.0, 1.0}, "m",
                "wall of a hollow tube, whose free ends are open to the scanner; 0 makes it solid");
  fields.number("mass", options.mass, {1e-6, 1e4}, "kg", "mass of one tube");
}

void check(const TubeOptions& options, const KeyPlaces& places, const std::string& prefix) {
  options.shape->check(options, places, prefix);
  if (options.wall_thickness >= options.radius)
    places.fail(prefix + ".wall_thickness", fmt::format("{} m leaves no bore in a radius of {} m; 0 makes it solid",
                                                        options.wall_thickness, options.radius));
}

void describe(Fields& fields, TubeKind& kind) {
  fields.text("name", kind.name,
              "what scene.json calls tubes of this kind; empty: the shape and the kind's place in the list, as ring_3");
  fields.integer("count", kind.count, {0, 10000}, "", "of this kind in each scene");
  fields.number("share", kind.share, {0.0, 1e6}, "",
                "weight of this kind where each of a scene's further tubes is drawn; shares need not sum to one");
  describe(fields, static_cast<TubeOptions&>(kind));
}

void check(const std::vector<TubeKind>& kinds, const std::vector<int>& tube_counts, const KeyPlaces& places) {
  if (kinds.empty()) return;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const std::string prefix = fmt::format("kinds[{}]", i);
    check(static_cast<const TubeOptions&>(kinds[i]), places, prefix);
    if (kinds[i].count == 0 && kinds[i].share == 0.0)
      places.fail(prefix, "neither a count nor a share: no tube would be of this kind");
    for (std::size_t j = 0; j < i; ++j)
      if (kind_name(kinds, j) == kind_name(kinds, i))
        places.fail(prefix + ".name", fmt::format("'{}' is kinds[{}]'s name already", kind_name(kinds, i), j));
  }
  const int fixed = total_count(kinds);
  for (const int count : tube_counts) {
    if (count < fixed)
      places.fail("tubes", fmt::format("{} tubes are fewer than the kinds' counts together, {}", count, fixed));
    if (count > fixed && total_share(kinds) == 0.0)
      places.fail("tubes", fmt::format("{} tubes are more than the kinds' counts together, {}, and no kind has a "
                                       "share of the others",
                                       count, fixed));
  }
}

std::vector<Tube> generate_tubes(int count, const TubeOptions& options, Random& random,
                                 const DrawOptions& draw_options) {
  std::vector<Tube> tubes;
  for (int m = 0; m < count; ++m) tubes.push_back(generate_tube(tubes.size(), 0, options, draw_options, random));
  return tubes;
}

std::string kind_name(const std::vector<TubeKind>& kinds, std::size_t index) {
  const TubeKind& kind = kinds[index];
  return kind.name.empty() ? fmt::format("{}_{}", kind.shape.name(), index + 1) : kind.name;
}

std::vector<Tube> generate_mixed_tubes(int count, const std::vector<TubeKind>& kinds, Random& random,
                                       const DrawOptions& draw_options) {
  std::vector<const TubeKind*> drawn;
  for (const TubeKind& kind : kinds) drawn.insert(drawn.end(), static_cast<std::size_t>(kind.count), &kind);
  while (static_cast<int>(drawn.size()) < count) drawn.push_back(draw_by_share(kinds, random));
  shuffle(drawn, random);
  std::vector<Tube> tubes;
  for (const TubeKind* kind : drawn) {
    const auto index = static_cast<std::size_t>(kind - kinds.data());
    tubes.push_back(generate_tube(tubes.size(), index, *kind, draw_options, random));
    tubes.back().kind = kind_name(kinds, index);
  }
  return tubes;
}

}  // namespace tubebin::tube
