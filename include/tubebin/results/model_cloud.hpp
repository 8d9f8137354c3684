/// Modelling one cloud file: what is known about its scene goes in beside it, and its results become files.
#pragma once

#include <optional>
#include <string>

#include "tubebin/modeling/pipeline.hpp"
#include "tubebin/results/cloud_files.hpp"
#include "tubebin/scene/input_hashes.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin::results {

/// Where the bin that is cropped comes from.
enum class BinSource {
  automatic,  ///< scene.json beside the cloud; without one, the cloud
  config,     ///< the configuration's `bin`
  cloud       ///< floor and walls are found in the cloud
};

/// Everything that model_tubes can be told.
struct ModelConfig {
  modeling::ModelingOptions modeling;
  BinSource bin_source = BinSource::automatic;
  scene::Bin bin;
  Vec3 bin_position = Vec3::Zero();      ///< metres, of the middle of its inner floor, in the cloud's frame
  Vec3 bin_rotation_deg = Vec3::Zero();  ///< roll, pitch, yaw: about x, then y, then z of the cloud's frame
  Vec3 viewpoint = Vec3::Zero();         ///< metres; zero: as the cloud says
};

void describe(Fields& fields, ModelConfig& config);
/// Throws ConfigError.
ModelConfig load_model_config(const std::string& path);

/// A cloud and what scene.json beside it says.
struct CloudToModel {
  std::string path;
  cloud::Cloud cloud;
  std::optional<scene::SceneRecord> scene;
  scene::InputHashes hashes;
  double read_seconds = 0.0;
  /// Told of sources 1, 2, ... of a merged cloud, while its world_from_sensor is source 0's; none: as scene.json says.
  std::vector<Pose> world_from_further_sensors = {};
};

/// Reads the cloud, its coordinates times `scale`, and scene.json in its folder if there is one. Throws IoError.
CloudToModel read_cloud_to_model(const std::string& path, double scale = 1.0);

/// The same of a scene of a data set. Throws IoError, too, where scene.json says that it is of another scene.
CloudToModel read_cloud_to_model(const scene::DatasetFiles& files, const CloudFile& cloud);

/// Models the cloud: its positions, its viewpoint or, with its sources, those of several scanners, and the scene's bin,
/// nothing else of what is there. Throws IoError, and ConfigError where viewpoints are told and not one for each source.
modeling::ModelingResult model_cloud(const CloudToModel& input, const ModelConfig& config);

/// Labels the cloud's filtered points by tubes that model_cloud found in it (modeling::label_tubes). Throws IoError.
modeling::ModelingResult label_cloud(const CloudToModel& input, const ModelConfig& config,
                                     std::vector<modeling::TubeModel> tubes);

/// The filtered points as they were, colours and labels included, in the input's order.
cloud::Cloud filtered_cloud(const cloud::Cloud& input, const modeling::ModelingResult& result);
/// The same points in the colours (label_colors) and with the labels of the tubes found.
cloud::Cloud labeled_cloud(const cloud::Cloud& input, const modeling::ModelingResult& result);
/// Every point of the input in its place, with the labels of the tubes found (ModelingOptions::label_all).
cloud::Cloud fully_labeled_cloud(const cloud::Cloud& input, const modeling::ModelingResult& result);
/// Colours of label 0 (the null colour) and every tube found.
std::vector<cloud::Color> model_colors(const modeling::ModelingResult& result);

}  // namespace tubebin::results
