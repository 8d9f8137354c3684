#include "tubebin/results/modeling_run.hpp"

#include <bit>
#include <map>

#include "tubebin/core/random.hpp"

namespace tubebin::results {
namespace {

std::uint64_t run_seed(std::uint64_t seed, const ModelingRun& run) {
  std::uint64_t mixed = derive_seed({seed, std::bit_cast<std::uint64_t>(run.ratio)});
  for (const char c : run.scene)
    mixed = derive_seed({mixed, static_cast<std::uint64_t>(static_cast<unsigned char>(c))});
  return mixed;
}

}  // namespace

ModelConfig run_config(const ModelConfig& config, const ModelingRun& run) {
  ModelConfig own = config;
  own.modeling.method = run.method;
  own.modeling.filtering.ratio = run.ratio;
  own.modeling.seed = run_seed(config.modeling.seed, run);
  return own;
}

std::vector<cloud::Label> truth_labels(const CloudToModel& input) {
  if (!input.cloud.labels.empty()) return input.cloud.labels;
  if (input.cloud.colors.empty() || !input.scene) return {};
  std::map<cloud::Color, cloud::Label> label_of;
  for (std::size_t k = 0; k < input.scene->colors.size(); ++k)
    label_of[input.scene->colors[k]] = static_cast<cloud::Label>(k);
  std::vector<cloud::Label> labels;
  for (const cloud::Color color : input.cloud.colors) {
    const auto entry = label_of.find(color);
    labels.push_back(entry == label_of.end() ? 0 : entry->second);
  }
  return labels;
}

}  // namespace tubebin::results
