#include "modeling/input/filtered_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "modeling/input/bin_faces.hpp"
#include "modeling/input/bin_finding.hpp"
#include "modeling/input/bin_pose.hpp"
#include "modeling/input/bin_rim.hpp"
#include "modeling/input/hanging_tubes.hpp"
#include "modeling/input/point_sample.hpp"
#include "modeling/input/scan_smoothing.hpp"
#include "modeling/input/viewpoint_check.hpp"
#include "modeling/scene_found.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin::modeling {
namespace {

/// Places that more than a hundredth of the points share, to the last bit.
std::vector<cloud::Point> shared_places(std::span<const cloud::Point> points) {
  constexpr std::size_t kSample = 2000, kShared = kSample / 100;
  std::vector<Vec3> sample = sample_of(points, kSample);
  std::ranges::sort(sample, [](const Vec3& a, const Vec3& b) { return std::ranges::lexicographical_compare(a, b); });
  std::vector<cloud::Point> places;
  for (auto first = sample.begin(); first != sample.end();) {
    const auto last = std::ranges::find_if(first, sample.end(), [&](const Vec3& point) { return point != *first; });
    if (static_cast<std::size_t>(last - first) > kShared) places.push_back(first->cast<float>());
    first = last;
  }
  return places;
}

/// Some scanners write all pixels without a measurement as one point, mostly (0, 0, 0). The points with those not finite; none
/// where no place is shared.
std::vector<cloud::Point> without_shared_places(std::span<const cloud::Point> points) {
  std::vector<cloud::Point> places = shared_places(points);
  if (std::ranges::count(points, cloud::Point(cloud::Point::Zero())) > 1) places.push_back(cloud::Point::Zero());
  if (places.empty()) return {};
  std::vector<cloud::Point> measured(points.begin(), points.end());
  std::ranges::replace_if(
      measured, [&](const cloud::Point& point) { return std::ranges::find(places, point) != places.end(); },
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
  Background of_bin = background_of_bin(input, projection, options);
  const bool is_alone = !has_surroundings(input, of_bin);
  const std::vector<std::uint32_t> beside = beside_bin(input, of_bin.set_aside, options.bin_margin);
  if (is_alone && beside.empty()) return of_bin;
  Background background = is_alone ? find_background(input, projection, beside) : find_background(input, projection);
  std::vector<std::uint32_t> not_flat;
  std::ranges::set_intersection(beside, background.foreground, std::back_inserter(not_flat));
  // Tubes over the walls lead over them.
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

/// Makes background of all that lies outside the box that tubes are looked for in.
void crop(Background& background, const ModelingInput& input, const ModelingOptions& options) {
  if (options.crop_min == options.crop_max) return;
  const Eigen::AlignedBox3d box(options.crop_min.cwiseMin(options.crop_max),
                                options.crop_min.cwiseMax(options.crop_max));
  const auto is_outside = [&](std::uint32_t i) { return !box.contains(input.points[i].cast<double>()); };
  std::erase_if(background.foreground, is_outside);
  if (background.foreground.empty() && std::ranges::all_of(background.set_aside, is_outside))
    throw IoError("no point lies in the box to crop to: is it in the cloud's frame, and in metres?");
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

}  // namespace

FilteredScene filter_scene(const ModelingInput& told, const ModelingOptions& options) {
  ModelingInput input = told;
  std::vector<cloud::Point> measured = without_shared_places(told.points);
  if (!measured.empty()) input.points = measured;
  ViewpointCheck viewpoint = check_viewpoint(input);
  FilteredScene scene = filter_from_viewpoint(input, options);
  double noise = 0.0;
  if (scene.background.is_noisy) {
    SmoothedScan scan = smoothed_scan(input, scene.projection);
    noise = scan.noise;
    measured = std::move(scan.points);
    input.points = measured;
    scene = filter_from_viewpoint(input, options);
  }
  // Twice: the other side of a wrong viewpoint may be another wrong one.
  for (int turn = 0; turn < 2 && !viewpoint.is_certain && is_seen_from_behind(scene.cloud, scene.projection); ++turn) {
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
  scene.found.noise_smoothed = noise;
  scene.measured = std::move(measured);
  return scene;
}

void set_aside(const std::vector<std::uint32_t>& indices, FilteredScene& scene) {
  move_points(indices, scene.background.foreground, scene.background.set_aside);
  const auto goes = [&](std::uint32_t i) { return std::ranges::binary_search(indices, i); };
  std::vector<std::uint32_t> left;
  for (std::uint32_t k = 0; k < scene.cloud.source.size(); ++k)
    if (!goes(scene.cloud.source[k])) left.push_back(k);
  scene.cloud = selected(scene.cloud, left);
  std::erase_if(scene.cloud.alone, goes);
}

void set_aside_faces(FilteredScene& scene) {
  if (!scene.found.bin || scene.input.bin) return;
  const Background& background = scene.background;
  set_aside(points_on_faces(*scene.found.bin, background.regions, scene.input.points, background.foreground,
                            background.spacing),
            scene);
}

}  // namespace tubebin::modeling
