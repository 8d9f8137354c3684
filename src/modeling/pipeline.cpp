#include "tubebin/modeling/pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "modeling/doubtful_tubes.hpp"
#include "modeling/end_discs.hpp"
#include "modeling/fitting/ball_finding.hpp"
#include "modeling/fitting/piece_cleaning.hpp"
#include "modeling/fitting/tube_classes.hpp"
#include "modeling/input/filtered_scene.hpp"
#include "modeling/input/normals.hpp"
#include "modeling/input/point_sample.hpp"
#include "modeling/joining/class_joining.hpp"
#include "modeling/mixed_pixels.hpp"
#include "modeling/point_labels.hpp"
#include "modeling/scene_found.hpp"
#include "modeling/seen_ends.hpp"
#include "modeling/steep_ends.hpp"

namespace tubebin::modeling {
namespace {

class Stopwatch {
 public:
  /// Adds the time since the last lap.
  void lap(double& seconds) {
    const auto now = std::chrono::steady_clock::now();
    seconds += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

std::vector<TubePiece> find_cylinder_pieces(const FilteredCloud& cloud, const std::vector<Segment>& segments,
                                            double radius, const RegionGrowingOptions& options) {
  std::vector<TubePiece> pieces;
  for (const Segment& segment : segments)
    for (TubePiece& piece : fit_cylinders(cloud, segment, radius, options)) pieces.push_back(std::move(piece));
  drop_explained_pieces(pieces, cloud.points, cloud.spacing);  // a tube whose surface made two regions is found twice
  return pieces;
}

/// Steps 2 to 4 of `--method region_growing`.
std::vector<TubeModel> grow_tubes(FilteredCloud& cloud, const ViewProjection& projection, double radius,
                                  const ModelingOptions& options, StageSeconds& seconds, Stopwatch& watch) {
  add_normals(cloud, projection, radius);
  watch.lap(seconds.filtering);
  const std::vector<Segment> segments = grow_regions(cloud, options.region_growing);
  watch.lap(seconds.segmentation);
  const std::vector<TubePiece> pieces = find_cylinder_pieces(cloud, segments, radius, options.region_growing);
  watch.lap(seconds.fitting);
  auto tubes = join_greedily(pieces, options.greedy_joining);
  watch.lap(seconds.joining);
  return tubes;
}

std::vector<double> told_radii(const ModelingOptions& options) {
  std::vector<double> radii;
  if (options.radius > 0.0) radii.push_back(options.radius);
  for (const OtherRadius& other : options.other_radii) radii.push_back(other.radius);
  return radii;
}

/// Radii and pieces; of `--method region_growing`, which finds pieces of its own, a told radius alone.
TubeClasses find_classes(const FilteredCloud& cloud, const ViewProjection& projection, const OcclusionTest& scan,
                         const Background& background, const SceneFound& found, const ModelingOptions& options) {
  const std::vector<double> radii = told_radii(options);
  if (options.method == ModelingMethod::region_growing && !radii.empty())
    return {.classes = {{.radius = radii.front(), .radius_error = 0.0, .pieces = {}}},
            .wires = {},
            .round = {},
            .on_rough_ground = false};
  return find_tube_classes(cloud, projection, scan, background.noise, background.is_known,
                           found.up_is_known ? found.up : Vec3::Zero(), radii);
}

/// Makes background of the points on the wires of a mesh.
void set_aside_mesh(const std::vector<TubePiece>& wires, FilteredScene& scene, SceneFound& found) {
  if (wires.empty()) return;
  found.wire_radius = wires.front().radius;
  std::vector<std::uint32_t> all = scene.cloud.source, left = without_pieces(scene.cloud, wires).source, on_wires;
  std::ranges::sort(all);
  std::ranges::sort(left);
  std::ranges::set_difference(all, left, std::back_inserter(on_wires));
  set_aside(on_wires, scene);
}

/// Of points that the tubes were not looked for in.
std::vector<cloud::Label> labels_of_further(const std::vector<std::uint32_t>& indices, const FilteredScene& scene,
                                            const std::vector<TubeModel>& tubes) {
  return label_further_points(points_at(scene.input.points, indices), tubes, scene.background);
}

constexpr cloud::Label kNone = std::numeric_limits<cloud::Label>::max();

/// Sets those that are not set yet: labels[k] that of the input's point indices[k].
void fill(std::vector<cloud::Label>& of_input, const std::vector<std::uint32_t>& indices,
          const std::vector<cloud::Label>& labels) {
  for (std::size_t k = 0; k < indices.size(); ++k)
    if (of_input[indices[k]] == kNone) of_input[indices[k]] = labels[k];
}

/// Labels of the filtered points, of those that lie alone, and of those that a plane took from a tube.
void label(FilteredScene& scene, PointLabels labels, const ModelingOptions& options, ModelingResult& result) {
  auto& [measured, input, found, projection, background, cloud] = scene;
  if (background.is_known && options.method == ModelingMethod::centerline)
    label_mixed_pixels(cloud, projection, result.tubes, labels.labels);
  result.noise = std::max(labels.noise, found.noise_smoothed);
  const auto unexplained = static_cast<double>(std::ranges::count(labels.labels, cloud::Label{0}));
  result.found.unexplained = unexplained / std::max(static_cast<double>(labels.labels.size()), 1.0);
  std::vector<cloud::Label> of_input(input.points.size(), kNone);
  fill(of_input, cloud.source, labels.labels);
  fill(of_input, cloud.alone, labels_of_further(cloud.alone, scene, result.tubes));

  const bool adds = options.filtering.ratio >= 1.0 && !input.bin;
  std::vector<cloud::Label> set_aside;
  if (adds || options.label_all)
    set_aside = label_set_aside(points_at(input.points, background.set_aside), result.tubes,
                                std::max(background.noise, labels.noise / 2.0), projection,
                                viewpoints_of(input, background.set_aside));
  for (std::size_t k = 0; adds && k < set_aside.size(); ++k)
    if (set_aside[k] > 0) of_input[background.set_aside[k]] = set_aside[k];
  for (std::uint32_t i = 0; i < of_input.size(); ++i) {
    if (of_input[i] == kNone) continue;
    result.source.push_back(i);
    result.labels.push_back(of_input[i]);
  }
  if (!options.label_all) return;
  fill(of_input, background.set_aside, set_aside);
  if (options.filtering.ratio < 1.0)
    fill(of_input, background.foreground, labels_of_further(background.foreground, scene, result.tubes));
  std::ranges::replace(of_input, kNone, cloud::Label{0});
  result.all_labels = std::move(of_input);
}

}  // namespace

const std::vector<std::string>& method_names() {
  static const std::vector<std::string> names = {"centerline", "region_growing"};
  return names;
}

const std::string& name_of(ModelingMethod method) { return method_names()[static_cast<std::size_t>(method)]; }

std::vector<ModelingMethod> all_methods() {
  std::vector<ModelingMethod> methods;
  for (std::size_t i = 0; i < method_names().size(); ++i) methods.push_back(static_cast<ModelingMethod>(i));
  return methods;
}

std::optional<ModelingMethod> method_called(const std::string& name) {
  for (const ModelingMethod method : all_methods())
    if (name == name_of(method)) return method;
  return std::nullopt;
}

void describe(Fields& fields, OtherRadius& other) {
  fields.number("radius", other.radius, {1e-6, 1.0}, "m", "outer radius of more of the tubes");
}

void describe(Fields& fields, ModelingOptions& options) {
  fields.choice("method", options.method, method_names(), "how tubes are found");
  fields.seed("seed", options.seed, "of downsampling and of RANSAC");
  fields.number("radius", options.radius, {0.0, 1.0}, "m", "outer radius of the tubes; 0: estimated from the cloud");
  fields.list("other_radii", options.other_radii, "where tubes of several radii are told");
  fields.number("tube_length", options.tube_length, {0.0, 100.0}, "m",
                "length of every tube; 0: a common one where it explains the scan best");
  fields.list("tube_shapes", options.tube_shapes,
              "shapes of the bent parts in the scene, for method centerline; none: found where tubes are bent alike");
  fields.vector("up", options.up, {-1.0, 1.0}, "",
                "against gravity, in the cloud's frame; zeros: found from what the tubes lie on");
  fields.vector("crop_min", options.crop_min, {-1000.0, 1000.0}, "m",
                "corner of the box that tubes are looked for in, in the cloud's frame; as crop_max: everywhere");
  fields.vector("crop_max", options.crop_max, {-1000.0, 1000.0}, "m", "the opposite corner");
  fields.group("filtering", "step 1", [&](Fields& inner) { describe(inner, options.filtering); });
  fields.group("region_growing", "steps 2 and 3 of that method",
               [&](Fields& inner) { describe(inner, options.region_growing); });
  fields.group("greedy_joining", "step 4 of that method",
               [&](Fields& inner) { describe(inner, options.greedy_joining); });
}

void check(const ModelingOptions& options, const KeyPlaces& places) {
  if (options.tube_shapes.empty()) return;
  for (std::size_t k = 0; k < options.tube_shapes.size(); ++k)
    check(options.tube_shapes[k], places, fmt::format("tube_shapes[{}]", k));
  if (options.method != ModelingMethod::centerline)
    places.fail("tube_shapes", fmt::format("is for method centerline, not for {}", name_of(options.method)));
  if (options.tube_length > 0.0) places.fail("tube_shapes", "tells the tubes' length; leave tube_length out");
}

ModelingResult model_tubes(const ModelingInput& told, const ModelingOptions& options) {
  ModelingResult result;
  Stopwatch watch;

  FilteredScene scene = filter_scene(told, options);
  auto& [measured, input, found, projection, background, cloud] = scene;
  result.found = found;
  result.spacing = cloud.spacing;
  OcclusionTest scan(input, projection, cloud.spacing * std::sqrt(options.filtering.ratio), 0.0);
  scan.add_solids(solids_of(background));
  watch.lap(result.seconds.filtering);

  auto [classes, wires, round, on_rough_ground] =
      find_classes(cloud, projection, scan, background, result.found, options);
  background.is_rough = on_rough_ground;
  set_aside_mesh(wires, scene, result.found);
  // What lies in a known bin is there to be found, whatever it is.
  std::vector<TubePiece> balls;
  if (input.bin && options.method == ModelingMethod::centerline)
    balls = find_balls(std::move(round), cloud, projection, background.noise, classes);
  for (const TubeClass& tube_class : classes) {
    result.radii.push_back(tube_class.radius);
    result.radius_errors.push_back(tube_class.radius_error);
  }
  if (!classes.empty()) result.radius = classes.front().radius;
  watch.lap(result.seconds.fitting);

  if (options.method == ModelingMethod::centerline) {
    result.tubes = join_classes(classes, scan, options, result);
    for (const TubePiece& ball : balls)
      result.tubes.push_back(
          {.paths = {{.nodes = ball.nodes, .bridged = {}, .evidence = ball.evidence}}, .radius = ball.radius});
    watch.lap(result.seconds.joining);
  } else if (result.radius > 0.0) {
    result.tubes = grow_tubes(cloud, projection, result.radius, options, result.seconds, watch);
  }

  set_aside_faces(scene);
  round_tubes(result.tubes);
  PointLabels labels = label_points(cloud.points, result.tubes, background);
  const auto label_again = [&] {
    round_tubes(result.tubes);
    labels = label_points(scene.cloud.points, result.tubes, scene.background);
  };
  if (options.method == ModelingMethod::centerline) {
    std::vector<WeakTube> weak;
    if (!background.is_known) {
      const std::size_t before = result.tubes.size();
      weak = drop_doubtful(result.tubes, result.lengths, labels.labels, background.is_rough);
      if (result.tubes.size() < before) label_again();
    }
    if (reach_steep_ends(result.tubes, cloud, labels.labels, projection, scan)) label_again();
    if (reach_seen_ends(result.tubes, cloud.points, labels.labels, cloud.spacing, result.lengths)) label_again();
    if (reach_end_discs(result.tubes, cloud, labels.labels, projection, scan, result.lengths)) label_again();
    if (restore_unexplained(weak, result.tubes, result.lengths, labels.labels)) label_again();
  }
  label(scene, std::move(labels), options, result);
  add_doubts(result, !told_radii(options).empty());
  watch.lap(result.seconds.labeling);
  return result;
}

ModelingResult label_tubes(const ModelingInput& told, std::vector<TubeModel> tubes, const ModelingOptions& options) {
  ModelingResult result;
  result.tubes = std::move(tubes);
  FilteredScene scene = filter_scene(told, options);
  result.found = scene.found;
  set_aside_faces(scene);
  label(scene, label_points(scene.cloud.points, result.tubes, scene.background), options, result);
  return result;
}

}  // namespace tubebin::modeling
