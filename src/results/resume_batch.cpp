#include "tubebin/results/resume_batch.hpp"

#include <fmt/ranges.h>

#include <filesystem>

#include "core/json_reader.hpp"
#include "results/results_index.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/version.hpp"

namespace tubebin::results {

namespace fs = std::filesystem;

ResumedBatch resume_batch(const std::vector<std::string>& results) {
  const std::string path = results.front() + "/" + kResultsIndexFile;
  const std::string text = read_file(path);
  const ResultsIndex index = parse_results_index(text, path);
  if (index.tool_version != tool_version())
    throw_config_error("{}: version {} made these results, and {} is running, whose results may differ", path,
                       index.tool_version, tool_version());
  ResumedBatch batch;
  BatchOptions& options = batch.options;
  options.dataset = (fs::path(results.front()) / index.dataset).lexically_normal().string();
  options.results = results.front();
  options.other_results.assign(results.begin() + 1, results.end());
  options.ratios = index.ratios;
  options.scenes = index.scenes;
  options.methods.clear();
  for (const std::string& name : index.methods) {
    const auto method = modeling::method_called(name);
    if (!method)
      throw_io_error("{}: /methods: \"{}\" is not valid; valid: \"{}\"", path, name,
                     fmt::join(modeling::method_names(), "\" or \""));
    options.methods.push_back(*method);
  }
  const nlohmann::json json = parse_json(text, path);
  JsonPlace(json, path).at("options").fields([&](Fields& fields) { describe(fields, batch.config); });
  return batch;
}

}  // namespace tubebin::results
