#include "tubebin/modeling/pipeline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "modeling/doubtful_tubes.hpp"
#include "modeling/fitting/ball_finding.hpp"
#include "modeling/fitting/centerline_fitting.hpp"
#include "modeling/fitting/centerline_pieces.hpp"
#include "modeling/fitting/centerline_segmentation.hpp"
#include "modeling/fitting/piece_cleaning.hpp"
#include "modeling/fitting/tube_classes.hpp"
#include "modeling/input/background.hpp"
#include "modeling/input/bin_finding.hpp"
#include "modeling/input/bin_pose.hpp"
#include "modeling/input/bin_rim.hpp"
#include "modeling/input/hanging_tubes.hpp"
#include "modeling/input/normals.hpp"
#include "modeling/input/viewpoint_check.hpp"
#include "modeling/joining/class_joining.hpp"
#include "modeling/mixed_pixels.hpp"
#include "modeling/point_labels.hpp"
#include "modeling/scene_found.hpp"
#include "modeling/seen_ends.hpp"
#include "tubebin/core/error.hpp"

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

/// Some scanners write a pixel without a measurement as the point (0, 0, 0). The points with those not finite; none where
/// at most one lies there.
std::vector<cloud::Point> without_zero_points(std::span<const cloud::Point> points) {
  const auto is_zero = [](const cloud::Point& point) { return point.isZero(0.0f); };
  if (std::ranges::count_if(points, is_zero) <= 1) return {};
  std::vector<cloud::Point> measured(points.begin(), points.end());
  std::ranges::replace_if(measured, is_zero,
                          cloud::Point(cloud::Point::Constant(std::numeric_limits<float>::quiet_NaN())));
  return measured;
}

/// Whether the foreground has more than tubes that hang over the walls: points farther from the bin than half its height.
bool has_surroundings(const ModelingInput& input, const Background& of_bin) {
  return 50 * beside_bin(input, of_bin.foreground, input.bin->height / 2.0).size() > of_bin.foreground.size();
}

/// Moves indices from one list to another. All ascend, before and after.
void move_points(const std::vector<std::uint32_t>& indices, std::vector<std::uint32_t>& from,
                 std::vector<std::uint32_t>& to) {
  std::vector<std::uint32_t> left, all;
  std::ranges::set_difference(from, indices, std::back_inserter(left));
  std::ranges::set_union(to, indices, std::back_inserter(all));
  from = std::move(left);
  to = std::move(all);
}

/// All of the background, and what of the foreground is none of `of_bin`'s.
Background without_surroundings(Background background, const Background& of_bin) {
  std::vector<std::uint32_t> around;
  std::ranges::set_difference(background.foreground, of_bin.foreground, std::back_inserter(around));
  move_points(around, background.foreground, background.set_aside);
  return background;
}

/// The background of a known bin, over whose walls tubes may hang; with other things around it, also what is flat of these,
/// and the rest proves that it is tubes.
Background background_around_bin(const ModelingInput& input, const ViewProjection& projection,
                                 const FilteringOptions& options) {
  Background of_bin = background_of_bin(input, options);
  const bool is_alone = !has_surroundings(input, of_bin);
  const std::vector<std::uint32_t> beside = beside_bin(input, of_bin.set_aside, options.bin_margin);
  if (is_alone && beside.empty()) return of_bin;
  Background background = is_alone ? find_background(input, projection, beside) : find_background(input, projection);
  std::vector<std::uint32_t> not_flat;
  std::ranges::set_intersection(beside, background.foreground, std::back_inserter(not_flat));
  // What is over the walls leads over them.
  const std::vector<std::uint32_t> over_walls = beside_bin(input, of_bin.foreground, -input.bin->wall_thickness);
  move_points(hanging_over(input.points, over_walls, not_flat, background.spacing), of_bin.set_aside,
              of_bin.foreground);
  return is_alone ? of_bin : without_surroundings(std::move(background), of_bin);
}

/// A known bin's floor and walls are background where the cloud shows them; a bin that it shows elsewhere is moved there,
/// and one that it does not show is unknown.
Background find_surroundings(ModelingInput& input, const ViewProjection& projection, const FilteringOptions& options) {
  if (input.bin && bin_is_in_place(input, std::max(options.bin_margin / 2.0, 1e-4)))
    return background_around_bin(input, projection, options);
  Background background = find_background(input, projection);
  if (!input.bin) return background;
  const auto pose = refined_bin_pose(input, background.regions);
  if (!pose) {
    input.bin.reset();
    return background;
  }
  input.world_from_bin = *pose;
  return background_around_bin(input, projection, options);
}

/// Radii and pieces; of `--method region_growing`, which finds pieces of its own, a told radius alone.
TubeClasses find_classes(FilteredCloud& cloud, const ViewProjection& projection, const OcclusionTest& scan,
                         const Background& background, const SceneFound& found, const ModelingOptions& options) {
  const std::vector<double> radii = told_radii(options);
  if (options.method == ModelingMethod::region_growing && !radii.empty())
    return {.classes = {{.radius = radii.front(), .radius_error = 0.0, .pieces = {}}}, .round = {}};
  return find_tube_classes(cloud, projection, scan, background.noise, background.is_known,
                           found.up_is_known ? found.up : Vec3::Zero(), radii);
}

/// What lies outside the box that tubes are looked for in counts as background.
void crop(Background& background, const ModelingInput& input, const ModelingOptions& options) {
  if (options.crop_min == options.crop_max) return;
  const Eigen::AlignedBox3d box(options.crop_min.cwiseMin(options.crop_max),
                                options.crop_min.cwiseMax(options.crop_max));
  std::erase_if(background.foreground, [&](std::uint32_t i) { return !box.contains(input.points[i].cast<double>()); });
}

/// Outliers and others that lie alone make a foreground's points seem farther apart than they lie in all of the scan (both
/// metres; 0: unknown). At the edges of thin tubes they seem so by a seventh. A few in one place seem to lie too close.
double spacing_without_lone_points(double of_foreground, double of_scan) {
  return of_scan > 0.0 ? std::clamp(of_foreground, 0.25 * of_scan, 1.25 * of_scan) : of_foreground;
}

/// The option's up direction, or that of a known bin; zero where neither tells it.
Vec3 told_up(const ModelingInput& input, const ModelingOptions& options) {
  return input.bin && options.up.isZero() ? Vec3(input.world_from_bin.linear().col(2)) : options.up;
}

/// A scene after step 1.
struct FilteredScene {
  std::vector<cloud::Point> measured;  ///< that `input` views; none: it views the points that were told
  ModelingInput input;                 ///< with viewpoint and bin as the cloud shows them
  SceneFound found;                    ///< but for what labels tell
  ViewProjection projection;
  Background background;
  FilteredCloud cloud;
};

/// An empty bin shows its own floor or walls.
void require_points_in_bin(const ModelingInput& input, const Background& background) {
  if (!input.bin || !background.foreground.empty()) return;
  if (beside_bin(input, background.set_aside, 0.0).size() == background.set_aside.size())
    throw IoError("no point lies in the bin: is its place right, and is the cloud in metres?");
}

/// Step 1 from the input's viewpoint.
FilteredScene filter_from_viewpoint(ModelingInput input, const ModelingOptions& options) {
  SceneFound found;
  const bool tells_bin = input.bin.has_value();
  const ViewProjection projection = view_of(input);
  Background background = find_surroundings(input, projection, options.filtering);
  require_points_in_bin(input, background);
  if (tells_bin && !input.bin) found.doubts.push_back("the bin that was told is not in the cloud: is its pose right?");
  describe_scene(background, projection, told_up(input, options), found);
  for (const Pose& pose : input.world_from_further_sensors) found.further_viewpoints.push_back(pose.translation());
  found.bin = input.bin ? std::optional(BinFound{.world_from_bin = input.world_from_bin,
                                                 .length = input.bin->length,
                                                 .width = input.bin->width,
                                                 .height = input.bin->height})
                        : find_bin(background, found.up, input.points);
  if (found.bin && !input.bin)
    move_points(points_on_rim(*found.bin, input.points, background.foreground,
                              5.0 * background.noise + background.spacing / 2.0, background.spacing),
                background.foreground, background.set_aside);
  crop(background, input, options);
  FilteredCloud cloud = filter(input, projection, background.foreground, options.filtering, options.seed);
  cloud.spacing = spacing_without_lone_points(cloud.spacing, background.spacing / std::sqrt(options.filtering.ratio));
  return {.measured = {},
          .input = std::move(input),
          .found = std::move(found),
          .projection = projection,
          .background = std::move(background),
          .cloud = std::move(cloud)};
}

/// Step 1 from where the scanner stood, as far as that is known.
FilteredScene filter_scene(const ModelingInput& told, const ModelingOptions& options) {
  ModelingInput input = told;
  std::vector<cloud::Point> measured = without_zero_points(told.points);
  if (!measured.empty()) input.points = measured;
  ViewpointCheck viewpoint = check_viewpoint(input);
  FilteredScene scene = filter_from_viewpoint(input, options);
  const auto is_wrong_side = [&] {
    add_normals(scene.cloud, scene.projection, 0.0);
    return is_seen_from_behind(scene.cloud, scene.projection);
  };
  // Twice: the other side of a wrong viewpoint may be another wrong one.
  for (int turn = 0; turn < 2 && !viewpoint.is_certain && is_wrong_side(); ++turn) {
    if (viewpoint.doubt.empty()) viewpoint.doubt = "its surfaces look hollow from there";
    look_from_the_other_side(input);
    scene = filter_from_viewpoint(input, options);
  }
  scene.found.viewpoint_is_told = viewpoint.doubt.empty();
  if (!scene.found.viewpoint_is_told)
    scene.found.doubts.insert(
        scene.found.doubts.begin(),
        fmt::format("the cloud was not seen from {}, as VIEWPOINT or --viewpoint has it: {}; {} is taken instead",
                    place_text(told.world_from_sensor.translation()), viewpoint.doubt,
                    place_text(scene.found.viewpoint)));
  if (!told_radii(options).empty()) scene.cloud.normals.clear();  // they are of no known radius
  scene.measured = std::move(measured);
  return scene;
}

/// Labels of the filtered points, and of those that a plane took from a tube.
void label(FilteredScene& scene, PointLabels labels, const ModelingOptions& options, ModelingResult& result) {
  auto& [measured, input, found, projection, background, cloud] = scene;
  if (background.is_known && options.method == ModelingMethod::centerline)
    label_mixed_pixels(cloud, projection, result.tubes, labels.labels);
  result.noise = labels.noise;
  result.labels = std::move(labels.labels);
  result.source = std::move(cloud.source);
  const auto unexplained = static_cast<double>(std::ranges::count(result.labels, cloud::Label{0}));
  result.found.unexplained = unexplained / std::max(static_cast<double>(result.labels.size()), 1.0);
  const bool adds = options.filtering.ratio >= 1.0 && !input.bin;
  if (!adds && !options.label_all) return;

  std::vector<cloud::Point> points;
  points.reserve(background.set_aside.size());
  for (const std::uint32_t i : background.set_aside) points.push_back(input.points[i]);
  const auto set_aside = label_set_aside(points, result.tubes, std::max(background.noise, labels.noise / 2.0),
                                         projection, viewpoints_of(input, background.set_aside));
  for (std::size_t k = 0; adds && k < points.size(); ++k) {
    if (set_aside[k] == 0) continue;
    result.source.push_back(background.set_aside[k]);
    result.labels.push_back(set_aside[k]);
  }
  if (!options.label_all) return;
  result.all_labels.assign(input.points.size(), 0);
  if (options.filtering.ratio < 1.0) {
    points.clear();
    for (const std::uint32_t i : background.foreground) points.push_back(input.points[i]);
    const auto labels = label_further_points(points, result.tubes, background.noise);
    for (std::size_t k = 0; k < points.size(); ++k) result.all_labels[background.foreground[k]] = labels[k];
  }
  for (std::size_t k = 0; k < set_aside.size(); ++k) result.all_labels[background.set_aside[k]] = set_aside[k];
  for (std::size_t k = 0; k < result.source.size(); ++k) result.all_labels[result.source[k]] = result.labels[k];
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

  auto [classes, round] = find_classes(cloud, projection, scan, background, result.found, options);
  // What lies in a known bin is there to be found, whatever it is.
  std::vector<TubePiece> balls;
  if (input.bin && options.method == ModelingMethod::centerline)
    balls = find_balls(std::move(round), cloud, background.noise, classes);
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

  round_tubes(result.tubes);
  PointLabels labels = label_points(cloud.points, result.tubes, background.noise);
  if (!background.is_known && options.method == ModelingMethod::centerline &&
      drop_doubtful(result.tubes, labels.labels))
    labels = label_points(cloud.points, result.tubes, background.noise);
  if (options.method == ModelingMethod::centerline &&
      reach_seen_ends(result.tubes, cloud.points, labels.labels, cloud.spacing, result.lengths)) {
    round_tubes(result.tubes);
    labels = label_points(cloud.points, result.tubes, background.noise);
  }
  label(scene, std::move(labels), options, result);
  add_doubts(result);
  watch.lap(result.seconds.labeling);
  return result;
}

ModelingResult label_tubes(const ModelingInput& told, std::vector<TubeModel> tubes, const ModelingOptions& options) {
  ModelingResult result;
  result.tubes = std::move(tubes);
  FilteredScene scene = filter_scene(told, options);
  result.found = scene.found;
  label(scene, label_points(scene.cloud.points, result.tubes, scene.background.noise), options, result);
  return result;
}

}  // namespace tubebin::modeling
