#include "modeling/input/background.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "modeling/input/scan_smoothing.hpp"
#include "modeling/input/source_views.hpp"
#include "modeling/input/view_grid.hpp"
#include "modeling/parallel.hpp"

namespace tubebin::modeling {
namespace {

/// Whether nothing of a sample of the scan lies behind the region, as deep as the thickest tube is wide.
bool is_solid(const FlatRegion& region, std::span<const cloud::Point> points, double spacing) {
  constexpr std::size_t kSample = 20000;
  const double deepest = 80.0 * spacing, inset = -3.0 * spacing;
  std::size_t before = 0, behind = 0;
  for (std::size_t i = 0; i < points.size(); i += points.size() / kSample + 1) {
    const Vec3 p = points[i].cast<double>();
    const double height = region.plane.height(p);
    if (std::abs(height) > deepest || !region.spans(p, inset)) continue;
    ++(height < -5.0 * region.noise - 0.5 * spacing ? behind : before);
  }
  return 50 * behind < before;
}

}  // namespace

Background find_background(const ModelingInput& input, const ViewProjection& projection) {
  std::vector<std::uint32_t> finite;
  finite.reserve(input.points.size());
  for (std::uint32_t i = 0; i < input.points.size(); ++i)
    if (cloud::is_finite(input.points[i])) finite.push_back(i);
  return find_background(input, projection, finite);
}

Background find_background(const ModelingInput& input, const ViewProjection& projection,
                           const std::vector<std::uint32_t>& finite) {
  Background background;
  const std::vector<SourceView> views = views_of(input, projection, finite);
  background.spacing = spacing_of(views);
  for (const SourceView& view : views) {
    FlatBlocks blocks(view);
    background.is_noisy |= is_noisy(view, blocks);
    for (FlatRegion& region : find_flat_regions(std::move(blocks), view)) {
      region.is_solid = is_solid(region, view.points, view.spacing.metres);
      background.regions.push_back(region);
    }
  }
  std::ranges::stable_sort(background.regions, std::ranges::greater(), &FlatRegion::area);
  if (!background.regions.empty()) background.noise = background.regions.front().noise;
  // A region's outermost blocks are not all its own.
  const double margin = 5.0 * background.spacing;
  std::vector<char> is_flat(finite.size());
  for_ranges_in_parallel(finite.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      const Vec3 p = input.points[finite[k]].cast<double>();
      is_flat[k] = std::ranges::any_of(background.regions, [&](const auto& r) { return r.holds(p, margin); });
    }
  });
  for (std::size_t k = 0; k < finite.size(); ++k)
    (is_flat[k] ? background.set_aside : background.foreground).push_back(finite[k]);
  return background;
}

Background background_of_bin(const ModelingInput& input, const ViewProjection& projection,
                             const FilteringOptions& options) {
  Background background{.regions = {}, .set_aside = {}, .foreground = crop_bin(input, options), .is_known = true};
  auto next = background.foreground.begin();
  for (std::uint32_t i = 0; i < input.points.size(); ++i) {
    if (next != background.foreground.end() && *next == i) ++next;
    else if (cloud::is_finite(input.points[i])) background.set_aside.push_back(i);
  }
  background.is_noisy = std::ranges::any_of(views_of(input, projection, background.foreground),
                                            [](const SourceView& view) { return is_noisy(view, FlatBlocks(view)); });
  return background;
}

std::vector<std::uint32_t> beside_bin(const ModelingInput& input, const std::vector<std::uint32_t>& indices,
                                      double margin) {
  const Pose bin_from_world = input.world_from_bin.inverse();
  const scene::Box bounds = scene::bin_bounds(*input.bin);
  const Eigen::Array2d low = bounds.min().head<2>().array() - margin, high = bounds.max().head<2>().array() + margin;
  std::vector<std::uint32_t> beside;
  for (const std::uint32_t i : indices) {
    const Eigen::Array2d p = (bin_from_world * input.points[i].cast<double>()).head<2>().array();
    if ((p < low).any() || (p > high).any()) beside.push_back(i);
  }
  return beside;
}

std::vector<FlatRegion> solids_of(const Background& background) {
  std::vector<FlatRegion> solids;
  std::ranges::copy_if(background.regions, std::back_inserter(solids), &FlatRegion::is_solid);
  return solids;
}

}  // namespace tubebin::modeling
