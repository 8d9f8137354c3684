#include "modeling/joining/occlusion.hpp"

#include <array>
#include <cmath>

namespace tubebin::modeling {
namespace {

float view_cell(const ModelingInput& input, const ViewProjection& projection, double spacing) {
  // Two spacings a cell: few cells of a surface are empty by chance, and a tube's gap is many cells wide still.
  const Vec3 middle = input.world_from_bin.translation();
  const double range = input.bin ? (middle - projection.viewpoint().cast<double>()).norm() : 1.0;
  return static_cast<float>(2.0 * spacing / range);
}

}  // namespace

OcclusionTest::OcclusionTest(const ModelingInput& input, const ViewProjection& projection, double spacing,
                             double radius)
    : viewpoint_(projection.viewpoint().cast<double>()),
      radius_(radius),
      image_(projection, input.points, view_cell(input, projection, spacing)),
      bin_(input.bin),
      bin_from_world_(input.world_from_bin.inverse()) {}

bool OcclusionTest::in_bin_solid(const Vec3& point) const {
  if (!bin_) return false;
  const Vec3 p = bin_from_world_ * point;
  if (p.z() > bin_->height) return false;
  return p.z() < 0.0 || std::abs(p.x()) > bin_->length / 2.0 || std::abs(p.y()) > bin_->width / 2.0;
}

StretchEvidence OcclusionTest::around(const Vec3& center, const Vec3& direction) const {
  if (in_bin_solid(center)) return {.hidden = 0.0, .surface = 0.0, .empty = 1.0};
  StretchEvidence sum;
  const Vec3 to_viewpoint = viewpoint_ - center;
  const Vec3 up = (to_viewpoint - to_viewpoint.dot(direction) * direction).normalized();
  const Vec3 side = direction.cross(up);
  // Half of the width is clear of what the silhouettes' neighbours cover by chance. Half a radius of tolerance is far
  // above the noise, and far below the tube's thickness by which a floor or another tube lies behind.
  for (const double across : {-0.5, 0.0, 0.5}) {
    const Vec3 surface = center + radius_ * (across * side + std::sqrt(1.0 - across * across) * up);
    switch (image_.evidence(surface.cast<float>(), static_cast<float>(radius_ / 2.0))) {
      case RangeImage::Evidence::hidden:
        sum.hidden += 1.0;
        break;
      case RangeImage::Evidence::surface:
        sum.surface += 1.0;
        break;
      case RangeImage::Evidence::empty:
        sum.empty += 1.0;
        break;
    }
  }
  return {sum.hidden / 3.0, sum.surface / 3.0, sum.empty / 3.0};
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
