#include "dataset/randomization.hpp"

#include <set>

#include "core/number_fields.hpp"

namespace tubebin::dataset {
namespace {

using Per = Distribution::Per;

/// These decide which scenes there are, and of which tubes.
bool is_same_for_all_scenes(const std::string& key) {
  static const std::set<std::string> keys = {"cases", "attempts_max", "attempt_time_limit", "sequence.lifts"};
  const bool is_mix = key.starts_with("kinds[") && (key.ends_with("].count") || key.ends_with("].share"));
  return is_mix || keys.contains(key);
}

bool is_of_a_tube(const std::string& key) { return key.starts_with("tube.") || key.starts_with("kinds["); }

Per how_often(const std::string& key, const Distribution& distribution) {
  return distribution.per.value_or(is_of_a_tube(key) ? Per::tube : Per::scene);
}

std::uint64_t stream_of(const std::string& key, std::uint64_t seed) {
  for (const char letter : key) seed = derive_seed({seed, static_cast<std::uint64_t>(letter)});
  return seed;
}

DrawnNumbers draw(const std::function<void(Fields&)>& describe, const Distributions& distributions, Per per,
                  std::uint64_t seed) {
  DrawnNumbers drawn;
  for (const auto& [key, field] : number_fields(describe)) {
    const auto found = distributions.find(key);
    if (found == distributions.end() || how_often(key, found->second) != per) continue;
    Random random(stream_of(key, seed));
    field.set(drawn[key] = found->second.draw(random));
  }
  return drawn;
}

/// For messages about numbers that no place in a file has.
KeyPlaces drawn_places() {
  KeyPlaces places;
  places.set("", "drawn");
  return places;
}

void check_one_for_all(const DatasetConfig& config, const KeyPlaces& places) {
  for (const auto& [key, distribution] : config.distributions) {
    if (is_same_for_all_scenes(key))
      places.fail(key, fmt::format("'{}' is not valid; valid: one number, for all scenes", distribution.text()));
    if (!is_of_a_tube(key) && distribution.per == Per::tube)
      places.fail(key, fmt::format("'{}' is not valid; valid: per: scene, since tubes share it", distribution.text()));
  }
}

}  // namespace

void check_distributions(const DatasetConfig& config, const KeyPlaces& places) {
  check_one_for_all(config, places);
  DrawnNumbers low, high;
  for (const auto& [key, distribution] : config.distributions) {
    low[key] = distribution.low();
    high[key] = distribution.high();
  }
  // What contradicts is a number that is too large for the others, or too small: each stands at one bound while all others
  // are at the other.
  for (const auto& [most, other] : {std::pair(low, high), std::pair(high, low)}) {
    check_numbers(with_numbers(config, most), places);
    for (const auto& [key, number] : other) {
      DrawnNumbers numbers = most;
      numbers[key] = number;
      check_numbers(with_numbers(config, numbers), places);
    }
  }
}

DrawnNumbers draw_scene_numbers(const DatasetConfig& config, std::uint64_t seed) {
  if (config.distributions.empty()) return {};
  DatasetConfig own = config;
  return draw(fields_of(own), config.distributions, Per::scene, seed);
}

DatasetConfig with_numbers(DatasetConfig config, const DrawnNumbers& drawn) {
  if (drawn.empty()) return config;
  const auto fields = number_fields(fields_of(config));
  for (const auto& [key, number] : drawn)
    if (const auto field = fields.find(key); field != fields.end()) field->second.set(number);
  return config;
}

void check_drawn(const DatasetConfig& config) {
  if (!config.distributions.empty()) check_numbers(config, drawn_places());
}

std::vector<tube::Tube> make_tubes(const DatasetConfig& config, int count, std::uint64_t seed, Random& random) {
  tube::DrawOptions draw_options;
  if (!config.distributions.empty())
    draw_options = [&](std::size_t number, std::size_t kind, tube::TubeOptions& options) {
      const std::string prefix = config.kinds.empty() ? "tube" : fmt::format("kinds[{}]", kind);
      const auto describe_tube = [&](Fields& fields) {
        fields.group(prefix.c_str(), "", [&](Fields& inner) { describe(inner, options); });
      };
      DrawnNumbers drawn = draw(describe_tube, config.distributions, Per::tube, derive_seed({seed, number + 1}));
      check(options, drawn_places(), prefix);
      return drawn;
    };
  return config.kinds.empty() ? tube::generate_tubes(count, config.tube, random, draw_options)
                              : tube::generate_mixed_tubes(count, config.kinds, random, draw_options);
}

}  // namespace tubebin::dataset
