/// A merged cloud as each of its scanners saw it.
#pragma once

#include <span>
#include <vector>

#include "modeling/input/view_grid.hpp"
#include "tubebin/modeling/modeling_input.hpp"
#include "tubebin/modeling/scan_view.hpp"

namespace tubebin::modeling {

/// The points that one scanner saw.
struct SourceView {
  ViewProjection projection;
  std::vector<cloud::Point> points;
  ViewProjection::Images images = {};
  PointSpacing spacing = {};
};

/// What each scanner saw of the points at `indices`, which are finite; without the scanners that saw none of them.
/// `first`: the projection of the first scanner.
std::vector<SourceView> views_of(const ModelingInput& input, const ViewProjection& first,
                                 std::span<const std::uint32_t> indices);

/// The root of the area that a point stands for in its own scanner's picture, metres. Where several scanners see a
/// surface its points lie closer.
double spacing_of(const std::vector<SourceView>& views);

/// Places of the scanners that saw the points at `indices`, metres; none where all have one.
std::vector<cloud::Point> viewpoints_of(const ModelingInput& input, std::span<const std::uint32_t> indices);

}  // namespace tubebin::modeling
