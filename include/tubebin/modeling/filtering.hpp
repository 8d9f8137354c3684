/// Step 1 of the paper's Section 4: points of the bin go, a random part of the rest stays, with surface normals.
#pragma once

#include <vector>

#include "tubebin/core/random.hpp"
#include "tubebin/core/yaml.hpp"
#include "tubebin/modeling/modeling_input.hpp"
#include "tubebin/modeling/scan_view.hpp"

namespace tubebin::modeling {

struct FilteringOptions {
  double ratio = 1.0;            ///< of the tube points that stay
  double bin_margin = 0.002;     ///< metres; points closer to floor or walls go
  bool remove_outliers = false;  ///< tubes are looked for without points that lie alone, as in the air along edges
};

void describe(Fields& fields, FilteringOptions& options);

/// The points that the later stages work on, in an order that their positions alone determine.
struct FilteredCloud {
  std::vector<std::uint32_t> source;  ///< index of each point in the input
  std::vector<cloud::Point> points;   ///< metres, world frame
  std::vector<cloud::Point> normals;  ///< unit, toward the viewpoint; zero where a point has too few neighbours; none
                                      ///< until they are estimated
  double spacing = 0.0;               ///< metres between neighbours: the root of the area that a point stands for
  std::vector<cloud::Point> viewpoints = {};  ///< of each point, metres; none: all the projection's
  std::vector<std::uint32_t> alone = {};      ///< indices in the input, of points that lie alone and were left out
};

/// The filtered cloud, yet without normals: of the points at `indices`, all that may be the tubes', a random part stays.
/// Empty where no point is left.
FilteredCloud filter(const ModelingInput& input, const ViewProjection& projection, std::vector<std::uint32_t> indices,
                     const FilteringOptions& options, std::uint64_t seed);

/// The cloud's points at `places` alone; without normals.
FilteredCloud selected(const FilteredCloud& cloud, const std::vector<std::uint32_t>& places);

/// Where the scanner stood that saw most of the points at `indices`, metres. `first`: of the projection.
Vec3 viewpoint_of(const FilteredCloud& cloud, std::span<const std::uint32_t> indices, const ViewProjection& first);

/// Radius of the neighbourhoods of normals, metres: large enough for some 25 points, which average the noise, where they
/// lie within half a tube's radius and the surface is nearly flat; else for some 16, within 0.65 radii.
double normal_radius(double spacing, double radius);

/// How many points show a stretch of tube that is fully visible, 2 r wide. Both and the points' spacing in metres.
double points_of_visible_stretch(double radius, double length, double spacing);

/// How many points show a flat end seen straight on. Its radius and the points' spacing in metres.
double points_of_flat_end(double radius, double spacing);

/// The projection of the scan: from the sensor toward what it saw.
ViewProjection view_of(const ModelingInput& input);

/// Indices of the points that do not belong to the known bin: all that are inside its walls or above its rim, farther
/// than the margin from its floor and walls.
std::vector<std::uint32_t> crop_bin(const ModelingInput& input, const FilteringOptions& options);

/// Keeps round(ratio * count) of the indices, at least one of any. Which ones depends on the seed and the points'
/// positions, not on their order.
std::vector<std::uint32_t> downsample(std::span<const cloud::Point> points, std::vector<std::uint32_t> indices,
                                      double ratio, std::uint64_t seed);

}  // namespace tubebin::modeling
