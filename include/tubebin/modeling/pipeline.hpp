/// model_tubes: from a cloud to tubes and labels, by the steps of the paper's Section 4.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tubebin/modeling/filtering.hpp"
#include "tubebin/modeling/greedy_joining.hpp"
#include "tubebin/modeling/region_growing.hpp"
#include "tubebin/modeling/tube_model.hpp"
#include "tubebin/modeling/tube_shape.hpp"

namespace tubebin::modeling {

enum class ModelingMethod { centerline, region_growing };

/// As options, configurations and results call them, in the order of the enumerators.
const std::vector<std::string>& method_names();
const std::string& name_of(ModelingMethod method);
std::vector<ModelingMethod> all_methods();
/// Nothing where no method has the name.
std::optional<ModelingMethod> method_called(const std::string& name);

/// One more radius of a scene with several.
struct OtherRadius {
  double radius = 0.0;  ///< metres
};

struct ModelingOptions {
  ModelingMethod method = ModelingMethod::centerline;
  std::uint64_t seed = 1;
  double radius = 0.0;                   ///< metres; 0: all radii are estimated from the cloud
  std::vector<OtherRadius> other_radii;  ///< beside `radius`
  double tube_length = 0.0;              ///< metres; 0: estimated from the cloud where its tubes agree
  std::vector<TubeShape> tube_shapes;    ///< of the kinds of part in the scene; none: found where tubes are bent alike
  Vec3 up = Vec3::Zero();        ///< against gravity, in the cloud's frame; zero: found from what the tubes lie on
  Vec3 crop_min = Vec3::Zero();  ///< metres, of the box that tubes are looked for in; as crop_max: everywhere
  Vec3 crop_max = Vec3::Zero();
  bool label_all = false;  ///< also label the input's other points (ModelingResult::all_labels)
  FilteringOptions filtering;
  RegionGrowingOptions region_growing;
  GreedyJoiningOptions greedy_joining;
};

void describe(Fields& fields, OtherRadius& other);
void describe(Fields& fields, ModelingOptions& options);
/// Throws ConfigError where options contradict each other.
void check(const ModelingOptions& options, const KeyPlaces& places);

/// Wall-clock seconds of each step.
struct StageSeconds {
  double filtering = 0.0;
  double segmentation = 0.0;
  double fitting = 0.0;
  double joining = 0.0;
  double labeling = 0.0;

  double total() const { return filtering + segmentation + fitting + joining + labeling; }
};

/// An open bin, as its inner faces show it.
struct BinFound {
  Pose world_from_bin = Pose::Identity();  ///< from the middle of its floor: x along the length, z up
  double length = 0.0, width = 0.0;        ///< metres, of the inner space at the floor; length is the longer
  double height = 0.0;                     ///< metres, of the walls above the floor
};

/// What the scene was found to be, and what looks wrong about it.
struct SceneFound {
  Vec3 up = Vec3::UnitZ();                    ///< unit
  bool up_is_known = false;                   ///< told, by a bin as well, or a support was found
  Vec3 viewpoint = Vec3::Zero();              ///< metres, of source 0
  std::vector<Vec3> further_viewpoints = {};  ///< of the other sources
  bool viewpoint_is_told = true;              ///< else found from the cloud
  double noise_smoothed = 0.0;      ///< metres, standard deviation of what was taken from a noisy scan; 0: as it is
  std::size_t flat_regions = 0;     ///< set aside as floor, walls and other obstacles
  double wire_radius = 0.0;         ///< metres, of a mesh's wires that were set aside; 0: no mesh
  std::optional<BinFound> bin;      ///< where the cloud shows one; nothing else rests on it
  double unexplained = 0.0;         ///< part of the filtered points that no tube explains
  std::vector<std::string> doubts;  ///< why the result may not be trusted, as sentences
};

struct ModelingResult {
  std::vector<std::uint32_t> source;  ///< of each filtered point, its index in the input, ascending
  std::vector<cloud::Label> labels;   ///< of each filtered point: k for tubes[k - 1], 0 where it belongs to none
  std::vector<TubeModel> tubes;
  double radius = 0.0;                ///< metres: as given, or as estimated
  std::vector<double> radii;          ///< metres, of all tubes, the commonest first
  std::vector<double> radius_errors;  ///< metres, standard deviations; 0 where told
  std::vector<double> lengths;        ///< metres, that tubes have in common: as given, or as estimated, ascending
  double noise = 0.0;    ///< metres, standard deviation of the points' distances to the fitted surfaces; of a scan
                         ///< that was smoothed, the noise before
  double spacing = 0.0;  ///< metres between neighbouring filtered points
  StageSeconds seconds;
  SceneFound found;
  std::vector<cloud::Label> all_labels;  ///< of each point of the input, with ModelingOptions::label_all
};

/// One line on what the scene was found to be.
std::string describe_found(const ModelingResult& result);

ModelingResult model_tubes(const ModelingInput& input, const ModelingOptions& options);

/// Steps 1 and 5 alone: the filtered points with the labels of tubes that are known. Of the result, `source`, `labels`,
/// `tubes` and `noise` are as model_tubes gives them where it finds these tubes.
ModelingResult label_tubes(const ModelingInput& input, std::vector<TubeModel> tubes, const ModelingOptions& options);

}  // namespace tubebin::modeling
