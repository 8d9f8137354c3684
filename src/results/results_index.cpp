#include "results/results_index.hpp"

#include <algorithm>
#include <limits>

#include "core/json_reader.hpp"
#include "results/setting_names.hpp"
#include "tubebin/core/confined_path.hpp"

namespace tubebin::results {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "tubebin results 1";
constexpr double kRunsMax = 20e6;

/// Each run has its own method, ratio and seed.
Json without_run(Json options) {
  if (!options.is_object()) return options;
  options.erase("method");
  if (options.contains("filtering") && options["filtering"].is_object()) options["filtering"].erase("ratio");
  return options;
}

template <typename Value>
void add_missing(const std::vector<Value>& held, std::vector<Value>& wanted) {
  for (const Value& value : held)
    if (std::find(wanted.begin(), wanted.end(), value) == wanted.end()) wanted.push_back(value);
}

}  // namespace

std::string ResultsIndex::configuration() const {
  return Json{
      {"tool_version", tool_version}, {"dataset", dataset}, {"seed", seed}, {"options", nlohmann::json(options)}}
      .dump(2);
}

std::string ResultsIndex::conditions() const {
  return Json{{"tool_version", tool_version}, {"seed", seed}, {"options", nlohmann::json(without_run(options))}}.dump();
}

ResultsIndex parse_results_index(std::string_view text, const std::string& name) {
  const nlohmann::json json = parse_json(text, name);
  const JsonPlace root(json, name);
  if (root.at("format").text() != kFormat) root.at("format").fail(fmt::format("\"{}\"", kFormat));
  ResultsIndex index;
  index.tool_version = root.at("tool_version").text();
  index.dataset = root.at("dataset").text();
  index.seed = root.at("seed").whole(0, std::numeric_limits<std::uint64_t>::max());
  for (const JsonPlace& method : root.at("methods").elements()) index.methods.push_back(method.text());
  for (const JsonPlace& ratio : root.at("ratios").elements()) index.ratios.push_back(ratio.number());
  for (const JsonPlace& scene : root.at("scenes").elements())
    index.scenes.push_back(ConfinedPath::parse(scene.text(), name + ": /scenes"));
  // Three short lists may ask for many runs.
  if (static_cast<double>(index.methods.size()) * static_cast<double>(index.ratios.size()) *
          static_cast<double>(index.scenes.size()) >
      kRunsMax)
    throw_io_error("{}: {} methods at {} ratios of {} scenes are too many runs; valid: up to {}", name,
                   index.methods.size(), index.ratios.size(), index.scenes.size(), kRunsMax);
  root.at("options");
  index.options = parse_ordered_json(text, name)["options"];
  return index;
}

std::string format_results_index(const ResultsIndex& index) {
  return Json{{"format", kFormat},        {"tool_version", index.tool_version},
              {"dataset", index.dataset}, {"methods", index.methods},
              {"ratios", index.ratios},   {"seed", index.seed},
              {"scenes", index.scenes},   {"options", index.options}}
             .dump(1) +
         "\n";
}

ResultsIndex merge_results_index(const ResultsIndex& held, ResultsIndex wanted, const std::string& path) {
  const auto require_same = [&](const char* key, const Json& a, const Json& b) {
    if (a != b)
      throw_config_error("{}: these results were made with {} = {}, not {}; choose another --output", path, key,
                         a.dump(), b.dump());
  };
  require_same("tool_version", held.tool_version, wanted.tool_version);
  require_same("dataset", held.dataset, wanted.dataset);
  require_same("seed", held.seed, wanted.seed);
  if (without_run(held.options) != without_run(wanted.options))
    throw_config_error("{}: these results were made with other options ({}); choose another --output", path,
                       describe_difference(held, wanted));
  add_missing(held.methods, wanted.methods);
  add_missing(held.ratios, wanted.ratios);
  add_missing(held.scenes, wanted.scenes);
  std::sort(wanted.ratios.begin(), wanted.ratios.end());
  return wanted;
}

}  // namespace tubebin::results
