#include "tubebin/modeling/pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "modeling/fitting/centerline_fitting.hpp"
#include "modeling/fitting/centerline_pieces.hpp"
#include "modeling/fitting/centerline_segmentation.hpp"
#include "modeling/fitting/piece_cleaning.hpp"
#include "modeling/input/normals.hpp"
#include "modeling/input/radius_estimation.hpp"
#include "modeling/joining/branch_joining.hpp"
#include "modeling/joining/tube_joining.hpp"
#include "modeling/labeling.hpp"
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

/// From the normals at first, then from what the points about the longest pieces say.
double estimate_radius_of(const FilteredCloud& cloud, const ViewProjection& projection) {
  constexpr std::size_t kPieces = 5;
  const double first = estimate_radius(cloud.points, cloud.normals, projection, cloud.spacing);
  if (first <= 0.0) return 0.0;
  // A quarter of a radius apart, a stretch of tube still has some ten votes in a voxel of segment_by_votes.
  const FilteredCloud sample = thinned(cloud, first / 4.0, projection, first);
  auto segments = segment_by_votes(sample, first);
  std::sort(segments.begin(), segments.end(), [](const Segment& a, const Segment& b) { return a.size() > b.size(); });
  const Vec3 viewpoint = projection.viewpoint().cast<double>();
  std::vector<TubePiece> pieces;
  for (std::size_t k = 0; k < segments.size() && pieces.size() < kPieces; ++k)
    if (auto piece = fit_centerline(sample, {segments[k], VoteGraph(sample, segments[k], first)}, {}, first, viewpoint))
      pieces.push_back(std::move(*piece));
  return refine_radius(pieces, sample.points, first);
}

/// Where points are sparse, normals from as many as a known radius would not let in are too flat: the radius that they
/// give makes better ones, and those a better radius.
double find_radius(FilteredCloud& cloud, const ViewProjection& projection) {
  double radius = estimate_radius_of(cloud, projection);
  const double reach = normal_radius(cloud.spacing, radius);
  if (radius <= 0.0 || reach > 0.9 * normal_radius(cloud.spacing, 0.0)) return radius;
  cloud.normals = estimate_normals(projection, cloud.points, reach);
  if (const double refined = estimate_radius_of(cloud, projection); refined > 0.0) radius = refined;
  return radius;
}

std::vector<TubePiece> find_cylinder_pieces(const FilteredCloud& cloud, const std::vector<Segment>& segments,
                                            double radius, const RegionGrowingOptions& options) {
  std::vector<TubePiece> pieces;
  for (const Segment& segment : segments)
    for (TubePiece& piece : fit_cylinders(cloud, segment, radius, options)) pieces.push_back(std::move(piece));
  drop_explained_pieces(pieces, cloud.points, cloud.spacing);  // a tube whose surface made two regions is found twice
  return pieces;
}

/// Whether the point may be of the tube's surface: within half a radius, beyond which are bridges' errors and strays.
bool is_about(const NearestSurface& nearest, double radius) {
  return nearest.surface != NearestSurface::kNone && std::abs(double(nearest.distance)) < radius / 2.0;
}

double standard_deviation(const std::vector<NearestSurface>& nearest, double radius) {
  double squares = 0.0, count = 0.0;
  for (const NearestSurface& n : nearest)
    if (is_about(n, radius)) squares += double(n.distance) * double(n.distance), count += 1.0;
  return count > 0.0 ? std::sqrt(squares / count) : 0.0;
}

/// The nearest tube of each point, in `surface`.
std::vector<NearestSurface> nearest_tubes(const FilteredCloud& cloud, const ModelingResult& result) {
  std::vector<TubeSurface> surfaces;
  std::vector<std::uint32_t> tube_of_surface;
  for (std::uint32_t t = 0; t < result.tubes.size(); ++t)
    for (const TubePath& path : result.tubes[t].paths) {
      surfaces.push_back({path.nodes, result.tubes[t].radius});
      tube_of_surface.push_back(t);
    }
  // Half a radius is what a bridge's guessed course may be off, as much again what a scanner strews about an edge. The
  // nearest tube wins all the same.
  auto nearest = nearest_surfaces(cloud.points, surfaces, result.radius);
  for (NearestSurface& n : nearest)
    if (n.surface != NearestSurface::kNone) n.surface = tube_of_surface[n.surface];
  return nearest;
}

/// Points about a tube lie on its surface; of points that happen to be somewhere within half a radius, two fifths lie in
/// the nearest two fifths. True if any tube went.
bool drop_tubes_of_chance(ModelingResult& result, const std::vector<NearestSurface>& nearest) {
  std::vector<double> points(result.tubes.size(), 0.0), on_surface(result.tubes.size(), 0.0);
  for (const NearestSurface& n : nearest) {
    if (!is_about(n, result.radius)) continue;
    points[n.surface] += 1.0;
    if (std::abs(double(n.distance)) < result.radius / 5.0) on_surface[n.surface] += 1.0;
  }
  std::size_t index = 0;
  return std::erase_if(result.tubes, [&](const TubeModel&) {
           const bool is_chance = on_surface[index] < 0.6 * points[index];
           ++index;
           return is_chance;
         }) > 0;
}

std::vector<cloud::Label> label_points(const FilteredCloud& cloud, ModelingResult& result) {
  auto nearest = nearest_tubes(cloud, result);
  if (drop_tubes_of_chance(result, nearest)) nearest = nearest_tubes(cloud, result);
  result.noise = standard_deviation(nearest, result.radius);
  std::vector<cloud::Label> labels;
  for (const NearestSurface& n : nearest) labels.push_back(n.surface == NearestSurface::kNone ? 0 : n.surface + 1);
  return labels;
}

}  // namespace

void describe(Fields& fields, ModelingOptions& options) {
  fields.choice("method", options.method, {"centerline", "region_growing"}, "how tubes are found");
  fields.seed("seed", options.seed, "of downsampling and of RANSAC");
  fields.number("radius", options.radius, {0.0, 1.0}, "m", "outer radius of the tubes; 0: estimated from the cloud");
  fields.number("tube_length", options.tube_length, {0.0, 100.0}, "m",
                "length of every tube; 0: what the tubes in sight agree on, if they do");
  fields.group("filtering", "step 1", [&](Fields& inner) { describe(inner, options.filtering); });
  fields.group("region_growing", "steps 2 and 3 of that method",
               [&](Fields& inner) { describe(inner, options.region_growing); });
  fields.group("greedy_joining", "step 4 of that method",
               [&](Fields& inner) { describe(inner, options.greedy_joining); });
}

ModelingResult model_tubes(const ModelingInput& input, const ModelingOptions& options) {
  ModelingResult result;
  Stopwatch watch;

  const ViewProjection projection = view_of(input);
  FilteredCloud cloud = filter(input, projection, options.filtering, options.seed);
  if (options.radius <= 0.0 || options.method == ModelingMethod::region_growing)
    add_normals(cloud, projection, options.radius);
  result.radius = options.radius > 0.0 ? options.radius : find_radius(cloud, projection);
  result.spacing = cloud.spacing;

  if (result.radius > 0.0 && options.method == ModelingMethod::centerline) {
    // Points that lie closer together cost time and add nothing: these make 24 votes a voxel of segment_by_votes.
    const FilteredCloud sample = thinned(cloud, result.radius / 6.0, projection, result.radius);
    watch.lap(result.seconds.filtering);
    const std::vector<Segment> segments = segment_by_votes(sample, result.radius);
    watch.lap(result.seconds.segmentation);
    const std::vector<TubePiece> pieces = find_centerline_pieces(sample, segments, projection, result.radius);
    watch.lap(result.seconds.fitting);
    const OcclusionTest occlusion(input, projection, cloud.spacing * std::sqrt(options.filtering.ratio), result.radius);
    Joining joining = join_pieces(pieces, occlusion, options.tube_length);
    result.tubes = joining.tubes_branch ? join_branches(joining.paths, result.radius, occlusion, options.tube_length)
                                        : unbranched(std::move(joining.paths), result.radius);
    result.tube_length = joining.tube_length;
    watch.lap(result.seconds.joining);
  } else if (result.radius > 0.0) {
    watch.lap(result.seconds.filtering);
    const std::vector<Segment> segments = grow_regions(cloud, options.region_growing);
    watch.lap(result.seconds.segmentation);
    const std::vector<TubePiece> pieces = find_cylinder_pieces(cloud, segments, result.radius, options.region_growing);
    watch.lap(result.seconds.fitting);
    result.tubes = join_greedily(pieces, options.greedy_joining);
    watch.lap(result.seconds.joining);
  }

  result.labels = label_points(cloud, result);
  watch.lap(result.seconds.labeling);
  result.source = std::move(cloud.source);
  return result;
}

}  // namespace tubebin::modeling
