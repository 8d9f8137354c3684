#include "modeling/fitting/radius_refining.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

#include "modeling/fitting/branch_splitting.hpp"
#include "modeling/fitting/centerline_fitting.hpp"
#include "modeling/fitting/centerline_pieces.hpp"
#include "modeling/fitting/centerline_segmentation.hpp"
#include "modeling/fitting/piece_evidence.hpp"
#include "modeling/input/radius_estimation.hpp"
#include "modeling/parallel.hpp"

namespace tubebin::modeling {
namespace {

struct Guess {
  const FilteredCloud& cloud;
  double radius;
  const ViewProjection& projection;
  const OcclusionTest& occlusion;

  bool is_round(const TubePiece& piece) const {
    const PieceEvidence evidence = examine_piece(piece, cloud, occlusion);
    return std::abs(evidence.curvature - 1.0) <= 0.4 && evidence.empty <= 0.3;
  }

  /// Of the pieces along curve_of(0) to curve_of(count - 1), longest first, as many that are round as a radius needs.
  std::vector<TubePiece> longest_round(std::size_t count, const std::function<VoteCurve(std::size_t)>& curve_of) const {
    constexpr std::size_t kEnough = 5;
    const auto round_piece = [&](std::size_t k) {
      const VoteCurve curve = curve_of(k);
      // Bends that are cut would make the radius too small.
      const auto piece = fit_centerline(cloud, curve, bend_tolerance({}, radius), {}, radius,
                                        viewpoint_of(cloud, curve.points, projection));
      return piece && is_round(*piece) ? std::vector{*piece} : std::vector<TubePiece>{};
    };
    std::vector<TubePiece> pieces;
    for (std::size_t next = 0; next < count && pieces.size() < kEnough;) {
      const std::size_t part = std::min(kEnough - pieces.size(), count - next);
      std::ranges::move(gather_in_parallel(part, [&](std::size_t k) { return round_piece(next + k); }),
                        std::back_inserter(pieces));
      next += part;
    }
    return pieces;
  }

  double radius_of(const std::vector<TubePiece>& pieces) const {
    return pieces.empty() ? 0.0 : refine_radius(pieces, cloud.points, radius);
  }
};

}  // namespace

double refined_radius(const FilteredCloud& cloud, double guess, const ViewProjection& projection,
                      const OcclusionTest& occlusion) {
  constexpr std::size_t kLongest = 12;
  const Guess guessed{cloud, guess, projection, occlusion};
  auto segments = segment_by_votes(cloud, guess);
  std::ranges::sort(segments, [](const Segment& a, const Segment& b) { return a.size() > b.size(); });
  if (segments.size() > kLongest) segments.resize(kLongest);
  std::vector<TubePiece> pieces = guessed.longest_round(segments.size(), [&](std::size_t k) {
    Split split = split_off_longest({segments[k], VoteGraph(cloud, segments[k], guess)}, guess);
    return find_vote_curve(cloud, std::move(split.longest), guess);
  });
  if (pieces.empty()) {
    // A ring's surface is no one piece.
    pieces = fit_curves(cloud, find_curves(cloud, segments, guess), projection, guess);
    std::erase_if(pieces, [&](const TubePiece& piece) { return !guessed.is_round(piece); });
  }
  return guessed.radius_of(pieces);
}

double radius_along(const std::vector<VoteCurve>& curves, const FilteredCloud& cloud, double guess,
                    const ViewProjection& projection, const OcclusionTest& occlusion) {
  constexpr std::size_t kLongest = 24;
  const Guess guessed{cloud, guess, projection, occlusion};
  std::vector<const VoteCurve*> longest;
  for (const VoteCurve& curve : curves) longest.push_back(&curve);
  std::ranges::stable_sort(longest, std::greater<>(), [](const VoteCurve* curve) { return curve->points.size(); });
  std::vector<TubePiece> pieces =
      guessed.longest_round(std::min(longest.size(), kLongest), [&](std::size_t k) { return *longest[k]; });
  std::erase_if(pieces, [&](const TubePiece& piece) { return piece.length() < kShort * guess; });
  return guessed.radius_of(pieces);
}

}  // namespace tubebin::modeling
