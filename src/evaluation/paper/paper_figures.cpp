#include "tubebin/evaluation/paper_figures.hpp"

#include <yaml-cpp/yaml.h>

extern const char* const kPaperResults;  // data/paper/results.yaml

namespace tubebin::evaluation {
namespace {

std::map<int, double> by_tubes(const YAML::Node& node) { return node.as<std::map<int, double>>(); }

PaperFigures parse(const YAML::Node& root) {
  PaperFigures figures;
  for (const auto& set : root["table_1_seconds_per_test_case"])
    figures.generation_seconds[set.first.as<std::string>()] = by_tubes(set.second);
  for (const auto& ratio : root["table_2_seconds_per_cloud_set_a"])
    figures.modelling_seconds[ratio.first.as<double>()] = by_tubes(ratio.second);
  figures.micro_recall_set_b = by_tubes(root["figure_8_micro_recall_set_b"]);
  return figures;
}

}  // namespace

const PaperFigures& paper_figures() {
  static const PaperFigures figures = parse(YAML::Load(kPaperResults));
  return figures;
}

}  // namespace tubebin::evaluation
