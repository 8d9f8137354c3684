#include "modeling/input/viewpoint_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "modeling/input/grid_viewpoint.hpp"
#include "modeling/input/open_view.hpp"
#include "modeling/input/point_sample.hpp"
#include "modeling/input/radius_estimation.hpp"
#include "tubebin/core/geometry.hpp"

namespace tubebin::modeling {
namespace {

/// Whether points lie all around: a scanner's view is narrower than a right angle about its axis, and of directions all around the
/// mean is next to nothing.
bool is_amid(const std::vector<Vec3>& points, const Vec3& place) {
  Vec3 directions = Vec3::Zero();
  for (const Vec3& point : points) directions += (point - place).normalized();
  return directions.norm() < 0.5 * static_cast<double>(points.size());
}

/// Few enough for a search that takes a moment, and enough to show what hides little.
std::vector<Vec3> search_sample(const ModelingInput& input) { return sample_of(input.points, 60000); }

}  // namespace

ViewpointCheck check_viewpoint(ModelingInput& input) {
  constexpr double kFarOff = 15.0;  // degrees, as the points see it
  // Of what scanners saw, a tenth at most lies as far behind something, in full bins.
  constexpr double kMostHidden = 0.12, kWidths = 8.0;
  constexpr std::size_t kSample = 20000, kFewest = 100;
  const std::vector<Vec3> sample = sample_of(input.points, kSample);
  if (sample.size() < kFewest || !input.sources.empty()) return {};
  const Vec3 told = input.world_from_sensor.translation();
  if (const auto seen = input.width > 0 ? viewpoint_of_grid(input.points, input.width) : std::nullopt) {
    const Vec3 middle = middle_of(sample);
    const double cosine = (told - middle).normalized().dot((*seen - middle).normalized());
    if (std::acos(std::clamp(cosine, -1.0, 1.0)) < radians(kFarOff)) return {};
    input.world_from_sensor.translation() = *seen;
    return {.doubt = "its rows and columns show another place"};
  }
  const double hidden = hidden_share(sample, told, kWidths);
  const bool is_within = is_amid(sample, told);
  if (!is_within && hidden <= kMostHidden) return {.doubt = {}, .is_certain = false};
  input.world_from_sensor.translation() = most_open_viewpoint(search_sample(input), Vec3::Zero());
  return {.doubt = is_within ? "its points lie all around"
                             : fmt::format("{:.0f} % of its points lie far behind others from there", 100.0 * hidden),
          .is_certain = false};
}

bool is_seen_from_behind(const FilteredCloud& cloud, const ViewProjection& projection) {
  const SurfaceNormals surface(cloud, projection, normal_radius(cloud.spacing, 0.0));
  const CurvedPlaces places = find_curved_places(cloud, surface, kSomePlaces);
  // By more than chance: of things with neither side, noise and corners make as many.
  constexpr double kDeviations = 2.5;
  const auto inward = static_cast<double>(places.hollow), outward = static_cast<double>(places.tubular.size());
  return inward - outward > kDeviations * std::sqrt(inward + outward);
}

void look_from_the_other_side(ModelingInput& input) {
  const std::vector<Vec3> sample = search_sample(input);
  auto viewpoint = input.world_from_sensor.translation();
  viewpoint = most_open_viewpoint(sample, viewpoint - middle_of(sample));
}

}  // namespace tubebin::modeling
