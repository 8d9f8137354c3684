#include "tubebin/modeling/filtering.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "modeling/input/neighborhoods.hpp"
#include "modeling/input/point_sample.hpp"
#include "modeling/input/source_views.hpp"
#include "modeling/input/view_grid.hpp"

namespace tubebin::modeling {
namespace {

/// A number that the seed and the point's position determine.
std::uint64_t position_key(const cloud::Point& point, std::uint64_t seed) {
  const auto x = std::bit_cast<std::uint32_t>(point.x());
  const auto y = std::bit_cast<std::uint32_t>(point.y());
  const auto z = std::bit_cast<std::uint32_t>(point.z());
  return derive_seed({seed, (std::uint64_t{x} << 32) | y, z});
}

/// The points at `indices`, of which there are some, in the order of the scanner's view, which their positions alone
/// determine.
FilteredCloud in_view_order(const ModelingInput& input, const ViewProjection& projection,
                            const std::vector<std::uint32_t>& indices) {
  const std::vector<cloud::Point> points = points_at(input.points, indices);
  FilteredCloud cloud;
  cloud.source.reserve(indices.size());
  cloud.points.reserve(indices.size());
  ViewProjection::Images images = projection.images(points);
  cloud.spacing =
      input.sources.empty() ? estimate_spacing(images).metres : spacing_of(views_of(input, projection, indices));
  const double range = double(images.range.front());
  const ViewGrid grid(std::move(images), points, static_cast<float>(std::max(2.0 * cloud.spacing / range, 1e-6)));
  for (const std::uint32_t k : grid.order()) {
    cloud.source.push_back(indices[k]);
    cloud.points.push_back(points[k]);
  }
  cloud.viewpoints = viewpoints_of(input, cloud.source);
  return cloud;
}

FilteredCloud without_lone_points(const ModelingInput& input, const ViewProjection& projection,
                                  const FilteredCloud& cloud) {
  const std::vector<bool> is_alone = lie_alone(projection, cloud.points, cloud.spacing);
  std::vector<std::uint32_t> kept, alone;
  for (std::size_t k = 0; k < cloud.source.size(); ++k) (is_alone[k] ? alone : kept).push_back(cloud.source[k]);
  std::ranges::sort(kept);
  FilteredCloud rest = kept.empty() ? FilteredCloud{} : in_view_order(input, projection, kept);
  rest.alone = std::move(alone);
  return rest;
}

}  // namespace

void describe(Fields& fields, FilteringOptions& options) {
  fields.number("ratio", options.ratio, {1e-6, 1.0}, "", "part of the tube points that stays, chosen at random");
  fields.number("bin_margin", options.bin_margin, {0.0, 1.0}, "m",
                "points closer than this to the bin's floor or walls go; several times the scanner's noise");
  fields.flag(
      "remove_outliers", options.remove_outliers,
      "look for tubes without points that have few neighbours, as scans without a filter have them in the air along all edges; these are "
      "labelled in the end");
}

std::vector<std::uint32_t> crop_bin(const ModelingInput& input, const FilteringOptions& options) {
  struct Limit {
    cloud::Point outward;
    float farthest;
  };
  const Eigen::Isometry3f bin_from_world = input.world_from_bin.inverse().cast<float>();
  const auto margin = static_cast<float>(options.bin_margin);
  std::vector<Limit> limits;
  for (const scene::InnerFace& face : scene::inner_faces(*input.bin))
    limits.push_back({face.outward.cast<float>(), static_cast<float>(face.offset) - margin});
  const float rim = static_cast<float>(input.bin->height) + margin;
  std::vector<std::uint32_t> inside;
  for (std::uint32_t i = 0; i < input.points.size(); ++i) {
    const cloud::Point p = bin_from_world * input.points[i];
    // Comparisons with NaN are false: pixels that hit nothing fall out here too.
    const bool between_walls =
        std::ranges::all_of(limits, [&](const Limit& limit) { return limit.outward.dot(p) < limit.farthest; });
    if (between_walls || (p.z() > rim && cloud::is_finite(p))) inside.push_back(i);
  }
  return inside;
}

std::vector<std::uint32_t> downsample(std::span<const cloud::Point> points, std::vector<std::uint32_t> indices,
                                      double ratio, std::uint64_t seed) {
  const auto kept = static_cast<std::size_t>(std::max(std::round(ratio * static_cast<double>(indices.size())), 1.0));
  if (kept >= indices.size()) return indices;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keyed;
  keyed.reserve(indices.size());
  for (const std::uint32_t i : indices) keyed.emplace_back(position_key(points[i], seed), i);
  std::nth_element(keyed.begin(), keyed.begin() + static_cast<std::ptrdiff_t>(kept), keyed.end());
  keyed.resize(kept);
  indices.clear();
  for (const auto& [key, i] : keyed) indices.push_back(i);
  std::sort(indices.begin(), indices.end());
  return indices;
}

double normal_radius(double spacing, double radius) {
  const double many = 2.8 * spacing, enough = 2.25 * spacing;  // 2.8^2 pi = 25 points, 16 points
  if (radius <= 0.0) return many;
  return std::max({std::min(many, 0.5 * radius), std::min(enough, 0.65 * radius), 1.5 * spacing});
}

double points_of_visible_stretch(double radius, double length, double spacing) {
  return 2.0 * radius * length / (spacing * spacing);
}

double points_of_flat_end(double radius, double spacing) {
  return std::numbers::pi * radius * radius / (spacing * spacing);
}

ViewProjection view_of(const ModelingInput& input) {
  Eigen::AlignedBox3f box;
  for (const cloud::Point& p : input.points)
    if (cloud::is_finite(p)) box.extend(p);
  return {input.world_from_sensor, box.isEmpty() ? cloud::Point(cloud::Point::Zero()) : cloud::Point(box.center())};
}

FilteredCloud filter(const ModelingInput& input, const ViewProjection& projection, std::vector<std::uint32_t> indices,
                     const FilteringOptions& options, std::uint64_t seed) {
  if (indices.empty()) return {};
  FilteredCloud cloud =
      in_view_order(input, projection, downsample(input.points, std::move(indices), options.ratio, seed));
  return options.remove_outliers ? without_lone_points(input, projection, cloud) : cloud;
}

FilteredCloud selected(const FilteredCloud& cloud, const std::vector<std::uint32_t>& places) {
  FilteredCloud part{.source = {}, .points = {}, .normals = {}, .spacing = cloud.spacing, .alone = cloud.alone};
  for (const std::uint32_t i : places) {
    part.source.push_back(cloud.source[i]);
    part.points.push_back(cloud.points[i]);
    if (!cloud.viewpoints.empty()) part.viewpoints.push_back(cloud.viewpoints[i]);
  }
  return part;
}

Vec3 viewpoint_of(const FilteredCloud& cloud, std::span<const std::uint32_t> indices, const ViewProjection& first) {
  if (cloud.viewpoints.empty() || indices.empty()) return first.viewpoint().cast<double>();
  std::vector<std::pair<std::size_t, cloud::Point>> counts;  // points of each viewpoint
  for (const std::uint32_t i : indices) {
    const auto known = std::ranges::find(counts, cloud.viewpoints[i], [](const auto& count) { return count.second; });
    if (known != counts.end()) ++known->first;
    else counts.emplace_back(1, cloud.viewpoints[i]);
  }
  return std::ranges::max_element(counts, {}, [](const auto& count) { return count.first; })->second.cast<double>();
}

}  // namespace tubebin::modeling
