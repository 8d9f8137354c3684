#include "tubebin/dataset/dataset_config.hpp"

#include <algorithm>
#include <charconv>
#include <set>

#include "dataset/randomization.hpp"
#include "tubebin/core/version.hpp"
#include "tubebin/render/preview.hpp"

namespace tubebin::dataset {
namespace {

constexpr Limits kTubeCountLimits = {1, 10000};

/// These say how much is wanted and how long to try; a finished scene's bytes don't depend on them.
const std::set<std::string> kKeysOfExtent = {"tubes", "cases", "attempts_max", "attempt_time_limit"};

void check_set_name(const DatasetConfig& config, const KeyPlaces& places) {
  const auto is_valid = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_' || c == '-'; };
  if (config.set.empty() || config.set.size() > 40 || !std::all_of(config.set.begin(), config.set.end(), is_valid))
    places.fail("set", fmt::format("'{}' is not valid; valid: 1 to 40 letters, '_' or '-' (it begins the names of "
                                   "folders, and digits after it count tubes)",
                                   config.set));
}

void check_tubes_once(const DatasetConfig& config, const KeyPlaces& places) {
  std::set<int> seen;
  for (const int count : config.tubes)
    if (!seen.insert(count).second) places.fail("tubes", fmt::format("{} stands in the list twice", count));
}

/// Far above what was ever made, far below what lists of their names fill the memory with.
constexpr std::size_t kScenesMax = 5'000'000;

void check_scene_count(const DatasetConfig& config, const KeyPlaces& places) {
  const std::size_t scenes = config.tubes.size() * static_cast<std::size_t>(config.cases) *
                             static_cast<std::size_t>(config.sequence.lifts + 1);
  if (scenes > kScenesMax)
    places.fail(
        "cases",
        fmt::format("{} for each of {} numbers of tubes, and their steps, are {} scenes; valid: up to {} together",
                    config.cases, config.tubes.size(), scenes, kScenesMax));
}

void check_version(const DatasetConfig& config, const KeyPlaces& places) {
  if (!config.tool_version.empty() && config.tool_version != tool_version())
    places.fail("tool_version", fmt::format("'{}' made this file and '{}' is running, whose scenes may differ; "
                                            "remove the key to use the configuration with this version",
                                            config.tool_version, tool_version()));
}

void check_preview(const DatasetConfig& config, const KeyPlaces& places) {
  if (config.output.preview && !render::can_render())
    places.fail("output.preview",
                "'true' is not possible: OSMesa, which draws, is missing, or was when this was built");
}

void check_depth_output(const DatasetConfig& config, const KeyPlaces& places) {
  if (!config.output.depth_image) return;
  constexpr auto kKey = "output.depth_image";
  if (!config.scanners.empty()) places.fail(kKey, "'true' is not possible with `scanners`, whose cloud is no image");
  if (config.scanner.region == scene::ScanRegion::tubes)
    places.fail(kKey, "'true' is not possible with scanner.region 'tubes', whose cloud is no image; valid: bin, full");
}

int parse_count(const std::string& text, const std::string& whole) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < kTubeCountLimits.min ||
      value > kTubeCountLimits.max)
    throw_config_error(
        "tubes: '{}' in '{}' is not valid; valid: numbers of tubes from {} to {} and ranges of them, "
        "as 1,5,10-15",
        text, whole, kTubeCountLimits.min, kTubeCountLimits.max);
  return value;
}

/// The scanners' numbers are drawn from what those of `scanner` are.
void inherit_distributions(DatasetConfig& config) {
  const std::string from = "scanner.";
  const Distributions before = config.distributions;
  for (const auto& [key, distribution] : before)
    for (std::size_t i = 0; key.starts_with(from) && i < config.scanners.size(); ++i)
      config.distributions[fmt::format("scanners[{}].{}", i, key.substr(from.size()))] = distribution;
}

/// What an element of the list does not say is as in `scanner`, which an included file may have set.
void describe_scanners(Fields& fields, DatasetConfig& config) {
  ScannerOptions fresh = config.scanner;
  fields.list(
      "scanners", "several scanners or poses, merged into one cloud, instead of `scanner`", config.scanners.size(),
      [&](std::size_t size) {
        config.scanners.assign(size, config.scanner);
        inherit_distributions(config);
      },
      [&](Fields& inner, std::size_t i) { describe(inner, i < config.scanners.size() ? config.scanners[i] : fresh); });
  if (config.scanners.empty())
    fields.group("scanner", "the virtual 3D scanner", [&](Fields& inner) { describe(inner, config.scanner); });
}

}  // namespace

std::vector<scene::Scanner> DatasetConfig::all_scanners() const {
  std::vector<scene::Scanner> all;
  for (const ScannerOptions& options : scanners.empty() ? std::vector{scanner} : scanners)
    all.push_back(options.posed());
  return all;
}

void describe(Fields& fields, DatasetConfig& config) {
  fields.randomized(config.distributions);
  fields.text("tool_version", config.tool_version,
              "version that made the data set, refused by any other; leave it out of a file of your own");
  fields.text("set", config.set, "name of the set; scenes are called <set><tubes>/<case>, as A10/007");
  fields.seed("seed", config.seed, "of all randomness; another seed makes other scenes");
  fields.integers("tubes", config.tubes, kTubeCountLimits, "numbers of tubes in the bin, each with its own scenes");
  fields.integer("cases", config.cases, {1, 1000000}, "", "scenes for each number of tubes");
  fields.integer("attempts_max", config.attempts_max, {1, 100000}, "",
                 "attempts, each with a seed of its own, until a scene is given up");
  fields.number(
      "attempt_time_limit", config.attempt_time_limit, {0.1, 86400.0}, "s",
      "wall-clock time after which an attempt counts as failed, and as much again for each of sequence.lifts; far "
      "above what any attempt needs, since hitting it depends on the machine");
  fields.list("kinds", config.kinds, "several kinds of tubes at once, instead of `tube`");
  if (config.kinds.empty())
    fields.group("tube", "shape of the tubes (paper, Algorithms 1 to 3)",
                 [&](Fields& inner) { describe(inner, config.tube); });
  fields.group("bin", "the bin, an open box where its walls are not said to be otherwise", [&](Fields& inner) {
    describe(inner, config.bin);
    describe_mesh(inner, config.bin);
  });
  fields.group("surroundings", "what stands around the bin, drawn for each pile; none by default",
               [&](Fields& inner) { describe(inner, config.surroundings); });
  fields.group("physics", "the drop and the checks of its result",
               [&](Fields& inner) { describe(inner, config.physics); });
  fields.group("sequence", "emptying the bin: tubes are lifted out one by one", [&](Fields& inner) {
    inner.integer("lifts", config.sequence.lifts, {0, 10000}, "",
                  "tubes lifted out of each pile, but for the last, with a scene before the first and after each: "
                  "A10/007/step_00, step_01, ...; 0 makes one scene of each pile, A10/007");
    inner.choice(
        "rule", config.sequence.rule, {"top", "random"},
        "which tube is next: of those with the fewest above them the one whose centre of mass is highest, or any");
    inner.number("speed", config.sequence.lift.speed, {0.001, 10.0}, "m/s", "at which it is pulled straight up");
  });
  describe_scanners(fields, config);
  fields.group("output", "what is written for each scene", [&](Fields& inner) {
    inner.choice("format", config.output.format, {"pcd_binary", "pcd_compressed", "pcd_ascii", "ply_binary"},
                 "file format of the cloud");
    describe(inner, config.output.space);
    inner.flag(
        "clean_cloud", config.output.clean_cloud,
        "also write cloud_clean, the scene as exact rays see it, pixel by pixel the twin of a cloud with effects");
    inner.flag("depth_image", config.output.depth_image,
               "also write depth.png and labels.png, the cloud's pixels as images of 16 bits, for networks");
    inner.flag("preview", config.output.preview,
               "also render preview.png and ground_truth.png, the colours in the scanner's view");
  });
}

std::function<void(Fields&)> fields_of(DatasetConfig& config) {
  return [&config](Fields& fields) { describe(fields, config); };
}

void check(const DatasetConfig& config, const KeyPlaces& places) {
  check_version(config, places);
  check_preview(config, places);
  check_of_any_version(config, places);
}

void check_of_any_version(const DatasetConfig& config, const KeyPlaces& places) {
  if (config.distributions.empty()) check_numbers(config, places);
  else check_distributions(config, places);
}

void check_numbers(const DatasetConfig& config, const KeyPlaces& places) {
  check_set_name(config, places);
  check_tubes_once(config, places);
  check_scene_count(config, places);
  check_depth_output(config, places);
  if (config.kinds.empty()) check(config.tube, places, "tube");
  check(config.kinds, config.tubes, places);
  check(config.bin, places, "bin");
  check(config.surroundings, config.bin, places, "surroundings");
  check(config.physics, places, "physics");
  if (config.scanners.empty()) check(config.scanner, config.bin, config.surroundings, places, "scanner");
  for (std::size_t i = 0; i < config.scanners.size(); ++i)
    check(config.scanners[i], config.bin, config.surroundings, places, fmt::format("scanners[{}]", i));
}

void load_bin_mesh(DatasetConfig& config, const KeyPlaces& places) {
  if (config.distributions.contains("bin.mesh_scale"))
    places.fail("bin.mesh_scale", "can't be drawn; valid: one number");
  load_mesh(config.bin, places, "bin");
}

DatasetConfig load_config(const std::string& path) {
  DatasetConfig config;
  const KeyPlaces places = read_yaml_file(path, fields_of(config));
  load_bin_mesh(config, places);
  check(config, places);
  config.tool_version = tool_version();
  return config;
}

std::string format_config(const DatasetConfig& config) {
  DatasetConfig fields = config;
  return write_yaml(fields_of(fields));
}

namespace {

/// The keys that each shape has in place of the chain's.
std::string document_shapes() {
  std::string text =
      "\n## Shapes\n\n"
      "The tables above have the keys of `shape: chain`. Other shapes have the keys below instead of `length` to\n"
      "`bend_angle_max_deg`; a key of another shape is an error. [shapes.md](shapes.md) says how each is made.\n\n"
      "`kinds` makes several kinds of tubes at once. It stands instead of `tube`, and each of its elements has the keys\n"
      "of `tube` beside `name`, `count` and `share`.\n\n"
      "`scanners` makes one cloud of several scanners. It stands instead of `scanner`, and each of its elements has the\n"
      "keys of `scanner`; what it leaves out is as in the `scanner` of an included file.\n";
  for (const std::string& name : tube::shape_names()) {
    tube::TubeOptions options;
    options.shape = tube::ShapeChoice(name);
    const auto describe_own = [&](Fields& fields) {
      fields.group("tube", "", [&](Fields& inner) { options.shape->describe(inner, options); });
    };
    if (name == tube::ShapeChoice().name()) continue;
    text += fmt::format("\n### {}\n\n", name);
    text += list_fields(describe_own).empty() ? "No keys of its own.\n" : document_fields(describe_own);
  }
  return text;
}

}  // namespace

std::string document_config() {
  DatasetConfig defaults;
  return "# Configuration of generate_dataset\n\n"
         "A configuration is a YAML file. A key that is missing keeps its default; an unknown key, a wrong type or an\n"
         "impossible value is an error that names the place in the file and what would be valid. A top-level key\n"
         "`include: other.yaml` (a path relative to the file) takes all values of that file first. A dot in a name\n"
         "below stands for nesting: `tube.radius` is the key `radius` in the mapping `tube`.\n\n"
         "Most numbers may be left open, to be drawn for each scene or tube, as `{uniform: [0.008, 0.016]}`:\n"
         "[randomization.md](randomization.md).\n\n"
         "`generate_dataset --config-reference` prints this page.\n\n" +
         document_fields(fields_of(defaults)) + document_shapes();
}

std::vector<std::string> differences(const DatasetConfig& there, const DatasetConfig& here) {
  constexpr auto kNothing = "nothing";
  DatasetConfig there_fields = there;
  DatasetConfig here_fields = here;
  if (there.bin.mesh != here.bin.mesh)  // the names of their content would mean nothing to the user
    for (DatasetConfig* config : {&there_fields, &here_fields})
      if (config->bin.surface) config->bin.mesh = config->bin.surface->path;
  const std::vector<KeyValue> a = list_fields(fields_of(there_fields));
  const std::vector<KeyValue> b = list_fields(fields_of(here_fields));
  std::vector<std::string> differing;
  const auto value_in = [](const std::vector<KeyValue>& fields, const std::string& key) -> std::string {
    const auto found = std::ranges::find(fields, key, &KeyValue::key_path);
    return found == fields.end() ? kNothing : found->value;
  };
  const auto compare = [&](const std::string& key, const std::string& value_there, const std::string& value_here) {
    if (value_there != value_here && !kKeysOfExtent.contains(key))
      differing.push_back(fmt::format("{}: {} there, {} here", key, value_there, value_here));
  };
  for (const auto& [key, value] : a) compare(key, value, value_in(b, key));
  // Shapes have keys of their own, and lists may be longer.
  for (const auto& [key, value] : b)
    if (value_in(a, key) == kNothing) compare(key, kNothing, value);
  return differing;
}

DatasetConfig unite(const DatasetConfig& there, DatasetConfig here) {
  std::vector<int> tubes = there.tubes;
  for (const int count : here.tubes)
    if (std::find(tubes.begin(), tubes.end(), count) == tubes.end()) tubes.push_back(count);
  here.tubes = tubes;
  here.cases = std::max(there.cases, here.cases);
  return here;
}

std::vector<int> parse_tube_counts(const std::string& text) {
  std::vector<int> counts;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string part = text.substr(begin, end - begin);
    const std::size_t dash = part.find('-');
    const int first = parse_count(part.substr(0, dash), text);
    const int last = dash == std::string::npos ? first : parse_count(part.substr(dash + 1), text);
    if (last < first) throw_config_error("tubes: the range '{}' in '{}' ends before it begins", part, text);
    for (int count = first; count <= last; ++count) counts.push_back(count);
    begin = end + 1;
  }
  return counts;
}

}  // namespace tubebin::dataset
