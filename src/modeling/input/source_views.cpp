#include "modeling/input/source_views.hpp"

#include <cmath>

#include "modeling/input/view_grid.hpp"
#include "tubebin/modeling/filtering.hpp"

namespace tubebin::modeling {
namespace {

const Pose& pose_of(const ModelingInput& input, std::uint32_t source) {
  return source == 0 ? input.world_from_sensor : input.world_from_further_sensors.at(source - 1);
}

ViewProjection projection_of(const ModelingInput& input, std::uint32_t source, std::span<const cloud::Point> points) {
  ModelingInput of_source;
  of_source.points = points;
  of_source.world_from_sensor = pose_of(input, source);
  return view_of(of_source);
}

}  // namespace

std::vector<SourceView> views_of(const ModelingInput& input, const ViewProjection& first,
                                 std::span<const std::uint32_t> indices) {
  std::vector<std::vector<cloud::Point>> points(1 + input.world_from_further_sensors.size());
  if (input.sources.empty()) points.front().reserve(indices.size());
  for (const std::uint32_t i : indices)
    points.at(input.sources.empty() ? 0 : input.sources[i]).push_back(input.points[i]);
  std::vector<SourceView> views;
  for (std::uint32_t source = 0; source < points.size(); ++source) {
    if (points[source].empty()) continue;
    SourceView view{.projection = source == 0 ? first : projection_of(input, source, points[source]),
                    .points = std::move(points[source])};
    view.images = view.projection.images(view.points);
    view.spacing = estimate_spacing(view.images);
    views.push_back(std::move(view));
  }
  return views;
}

double spacing_of(const std::vector<SourceView>& views) {
  if (views.size() == 1) return views.front().spacing.metres;
  double area = 0.0, count = 0.0;
  for (const SourceView& view : views) {
    area += static_cast<double>(view.points.size()) * view.spacing.metres * view.spacing.metres;
    count += static_cast<double>(view.points.size());
  }
  return count > 0.0 ? std::sqrt(area / count) : 0.0;
}

std::vector<cloud::Point> viewpoints_of(const ModelingInput& input, std::span<const std::uint32_t> indices) {
  std::vector<cloud::Point> viewpoints;
  if (input.sources.empty()) return viewpoints;
  viewpoints.reserve(indices.size());
  for (const std::uint32_t i : indices)
    viewpoints.push_back(pose_of(input, input.sources[i]).translation().cast<float>());
  return viewpoints;
}

}  // namespace tubebin::modeling
