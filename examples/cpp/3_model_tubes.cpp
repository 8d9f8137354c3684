/// 3_model_tubes: finds the tubes in cloud.pcd by its positions alone; labeled.pcd says which tube each point of
/// filtered.pcd belongs to.
#include <iostream>

#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/results/model_cloud.hpp"

int main() try {
  using namespace tubebin;
  results::ModelConfig config;
  config.modeling.filtering.ratio = 0.5;  // half of the points will do

  const results::CloudToModel input = results::read_cloud_to_model("cloud.pcd");
  const modeling::ModelingResult model = results::model_cloud(input, config);
  cloud::write_cloud("filtered.pcd", results::filtered_cloud(input.cloud, model), cloud::CloudFormat::pcd_binary);
  cloud::write_cloud("labeled.pcd", results::labeled_cloud(input.cloud, model), cloud::CloudFormat::pcd_binary);
  std::cout << model.tubes.size() << " tubes of radius " << model.radius * 1e3 << " mm\n";
  for (const modeling::TubeModel& tube : model.tubes)
    std::cout << tube.cylinder_count() << " cylinders, " << tube.length() << " m\n";
} catch (const tubebin::IoError& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
