/// index.json: what a results folder is to hold, and what its runs depend on (docs/results_format.md).
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace tubebin::results {

constexpr const char* kResultsIndexFile = "index.json";

struct ResultsIndex {
  std::string tool_version;
  std::string dataset;  ///< as it stands there, relative to the folder
  std::vector<std::string> methods;
  std::vector<double> ratios;
  std::uint64_t seed = 0;
  std::vector<std::string> scenes;
  nlohmann::ordered_json options;  ///< of the modeler

  /// What all runs depend on, as JSON for people.
  std::string configuration() const;
  /// The same without the data set's place and what each run has its own of.
  std::string conditions() const;
};

/// Throws IoError naming the place in `name`.
ResultsIndex parse_results_index(std::string_view text, const std::string& name);
std::string format_results_index(const ResultsIndex& index);

/// `wanted` with the methods, ratios and scenes that `held`, the index at `path`, has already. Throws ConfigError where
/// what the runs depend on differs.
ResultsIndex merge_results_index(const ResultsIndex& held, ResultsIndex wanted, const std::string& path);

}  // namespace tubebin::results
