#include "modeling/joining/occlusion.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "modeling/input/source_views.hpp"
#include "modeling/median.hpp"

namespace tubebin::modeling {
namespace {

/// Places across a tube that are looked at together.
constexpr std::size_t kMostAcross = 3;
/// Of the angle between a tube and the ray to it. Tubes that point at the scanner show hardly any of their sides.
constexpr double kLeastSine = 0.25;

float view_cell(std::span<const cloud::Point> points, const ViewProjection& projection, double spacing) {
  constexpr std::size_t kSample = 1000;
  std::vector<float> ranges;
  for (std::size_t i = 0; i < points.size(); i += points.size() / kSample + 1)
    if (cloud::is_finite(points[i])) ranges.push_back((points[i] - projection.viewpoint()).norm());
  // Two spacings a cell: few cells of a surface are empty by chance, and a tube's gap is many cells wide still.
  return static_cast<float>(2.0 * spacing / (ranges.empty() ? 1.0 : double(median(ranges))));
}

}  // namespace

OcclusionTest::OcclusionTest(const ModelingInput& input, const ViewProjection& projection, double spacing,
                             double radius)
    : radius_(radius),
      views_(std::make_shared<std::vector<View>>(views(input, projection, spacing))),
      bin_(input.bin),
      bin_faces_(bin_ ? scene::inner_faces(*bin_) : std::vector<scene::InnerFace>()),
      bin_from_world_(input.world_from_bin.inverse()) {}

std::vector<OcclusionTest::View> OcclusionTest::views(const ModelingInput& input, const ViewProjection& projection,
                                                      double spacing) {
  std::vector<View> views;
  const auto add = [&](const ViewProjection& of_view, std::span<const cloud::Point> points, double apart) {
    const float cell = view_cell(points, of_view, apart);
    views.push_back({of_view.viewpoint().cast<double>(), {of_view, points, cell}, cell});
  };
  if (input.sources.empty()) {
    add(projection, input.points, spacing);
    return views;
  }
  std::vector<std::uint32_t> finite;
  for (std::uint32_t i = 0; i < input.points.size(); ++i)
    if (cloud::is_finite(input.points[i])) finite.push_back(i);
  for (const SourceView& view : views_of(input, projection, finite))
    add(view.projection, view.points, view.spacing.metres);
  return views;
}

bool OcclusionTest::in_solid(const Vec3& point) const {
  if (std::ranges::any_of(solids_, [&](const FlatRegion& solid) {
        const double height = solid.plane.height(point);
        return height < 0.0 && height > -2.0 * radius_ && solid.spans(point, 0.0);
      }))
    return true;
  if (!bin_) return false;
  const Vec3 p = bin_from_world_ * point;
  if (p.z() > bin_->height) return false;
  return std::ranges::any_of(bin_faces_, [&](const scene::InnerFace& face) { return face.depth_inside(p) < 0.0; });
}

StretchEvidence OcclusionTest::around(const Vec3& center, const Vec3& direction) const {
  if (in_solid(center)) return {.hidden = 0.0, .surface = 0.0, .empty = 1.0, .no_data = 0.0};
  // Half of the width is clear of what the silhouettes' neighbours cover by chance.
  constexpr double kMiddle[] = {-0.5, 0.0, 0.5};
  StretchEvidence evidence = evidence_across(center, direction, kMiddle);
  // Behind a tube that is not there the scanner would mostly have measured something, or nothing is in reach.
  evidence.empty += evidence.no_data;
  return evidence;
}

StretchEvidence OcclusionTest::sides(const Vec3& center, const Vec3& direction) const {
  constexpr double kSides[] = {-0.8, 0.8};
  return evidence_across(center, direction, kSides);
}

OcclusionTest OcclusionTest::with_radius(double radius) const {
  OcclusionTest other = *this;
  other.radius_ = radius;
  return other;
}

OutlineEvidence OcclusionTest::outline(const Vec3& center, const Vec3& direction) const {
  constexpr double kFlank = 0.85, kBeside = 1.25;
  const auto height = [](double x) { return std::sqrt(1.0 - x * x); };
  // A cell of the scan has its nearest point's range, half a cell up the flank on average.
  const View& view = views_->front();
  const double half_cell = 0.5 * view.cell * (view.viewpoint - center).norm() / radius_;
  const double bias = height(std::max(kFlank - half_cell, 0.0)) - height(kFlank);
  const double least = std::max(0.1 + bias, 0.2), most = 1.0;  // in front of the flank, radii
  const double middle = height(kFlank) + (least + most) / 2.0;
  const Place flanks[] = {{-kFlank, middle}, {kFlank, middle}};
  // From 0.6 radii below the axis to 0.3 above: another tube that touches this one's side is higher or lower.
  constexpr double kLow = -0.15, kTolerance = 0.45;
  const Place beside[] = {{-kBeside, kLow}, {kBeside, kLow}};
  const StretchEvidence past = evidence_at(center, direction, beside, kTolerance);
  return {.edge = past.empty,
          .level = past.surface,
          .flat = evidence_at(center, direction, flanks, (most - least) / 2.0).surface};
}

StretchEvidence OcclusionTest::evidence_across(const Vec3& center, const Vec3& direction,
                                               std::span<const double> across) const {
  std::array<Place, kMostAcross> places;
  for (std::size_t k = 0; k < across.size(); ++k) places[k] = {across[k], std::sqrt(1.0 - across[k] * across[k])};
  // Half a radius of tolerance is far above the noise, and far below the tube's thickness by which a floor or another
  // tube lies behind.
  return evidence_at(center, direction, std::span(places).first(across.size()), 0.5);
}

StretchEvidence OcclusionTest::evidence_at(const Vec3& center, const Vec3& direction, std::span<const Place> places,
                                           double tolerance) const {
  using Evidence = RangeImage::Evidence;
  std::array<Evidence, kMostAcross> seen;
  seen.fill(Evidence::beyond);
  for (const View& view : *views_) {
    const Vec3 to_viewpoint = view.viewpoint - center;
    const Vec3 across = to_viewpoint - to_viewpoint.dot(direction) * direction;
    const Vec3 up = across.normalized();
    const double sine = std::max(across.norm() / to_viewpoint.norm(), kLeastSine);
    const double in_range = tolerance * radius_ / sine;
    const Vec3 side = direction.cross(up);
    for (std::size_t k = 0; k < places.size(); ++k) {
      const Vec3 place = center + radius_ * (places[k].x() * side + places[k].y() * up);
      seen[k] = std::max(seen[k], view.image.evidence(place.cast<float>(), static_cast<float>(in_range)));
    }
  }
  StretchEvidence sum;
  for (const Evidence evidence : std::span(seen).first(places.size())) switch (evidence) {
      case Evidence::outside:
      case Evidence::missing:
      case Evidence::hidden:
        sum.hidden += 1.0;
        break;
      case Evidence::no_data:
        sum.no_data += 1.0;
        break;
      case Evidence::surface:
        sum.surface += 1.0;
        break;
      case Evidence::beyond:
      case Evidence::empty:
        sum.empty += 1.0;
        break;
    }
  const auto count = static_cast<double>(places.size());
  return {sum.hidden / count, sum.surface / count, sum.empty / count, sum.no_data / count};
}

RangeImage::Evidence OcclusionTest::facing(const Vec3& place, const Vec3& normal) const {
  // Surfaces seen more obliquely are off in range by more than the tolerance within a cell.
  constexpr double kFacing = 0.3;
  RangeImage::Evidence seen = RangeImage::Evidence::outside;
  for (const View& view : *views_)
    if ((view.viewpoint - place).normalized().dot(normal) > kFacing)
      seen = std::max(seen, view.image.evidence(place.cast<float>(), static_cast<float>(radius_ / 4.0)));
  return seen;
}

double OcclusionTest::empty_part(const std::vector<Vec3>& curve, double enough) const {
  // Neighbours look alike: of many, every other one does, and every fourth at first finds out soonest.
  constexpr std::size_t kStride = 4, kMany = 16;
  constexpr std::array<std::size_t, kStride> kFirst = {0, 2, 1, 3};
  const bool is_long = curve.size() > kMany;
  const auto samples = static_cast<double>(is_long ? curve.size() / 2 : curve.size() - 1);
  double empty = 0.0;
  for (std::size_t round = 0; round < (is_long ? kStride / 2 : kStride); ++round)
    for (std::size_t i = kFirst[round]; i + 1 < curve.size() && empty < enough * samples; i += kStride) {
      const Vec3 step = curve[i + 1] - curve[i];
      empty += around(curve[i] + 0.5 * step, step.normalized()).empty;
    }
  return empty / samples;
}

double OcclusionTest::hidden_reach(const Vec3& end, const Vec3& outward, double limit) const {
  for (double reach = radius_ / 2.0; reach < limit; reach += radius_ / 2.0)
    if (around(end + reach * outward, outward).empty > 0.5) return reach;
  return limit;
}

}  // namespace tubebin::modeling
