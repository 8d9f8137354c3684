#include "modeling/fitting/tube_classes.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>

#include "modeling/fitting/branch_splitting.hpp"
#include "modeling/fitting/centerline_fitting.hpp"
#include "modeling/fitting/centerline_pieces.hpp"
#include "modeling/fitting/centerline_segmentation.hpp"
#include "modeling/fitting/piece_cleaning.hpp"
#include "modeling/fitting/piece_evidence.hpp"
#include "modeling/fitting/tube_stretches.hpp"
#include "modeling/fitting/vote_sheets.hpp"
#include "modeling/input/normals.hpp"
#include "modeling/input/radius_estimation.hpp"
#include "modeling/median.hpp"
#include "modeling/parallel.hpp"

namespace tubebin::modeling {
namespace {

constexpr std::size_t kMostClasses = 4, kMostTries = 8;

/// So many pieces are joined in a second or two; a pile of a hundred tubes has some five hundred.
constexpr std::size_t kMostPieces = 1500;

/// A hundred tubes, forty radii long and seen from end to end, have as many a sixth of a radius apart. Where the points that
/// were looked through for the radii so far are more, no further radius is looked for.
constexpr std::size_t kMostPoints = 300'000;

/// In nats, of a radius' long pieces, which then know it to 1 %. Edges and rims seem round here and there, and of no one
/// radius. Less is believed where no radius has as much.
constexpr double kEnoughEvidence = 5000.0;
/// And of a further radius as a part of the first one's: where tubes branch or touch, some surface is as round as a thicker tube.
constexpr double kFurtherShare = 0.01;

/// Of what is not flat, the part on tubes and what looks like them: beside a bin or on a table more, on rough ground less.
constexpr double kMostlyTube = 0.4;

/// In units of 1 / radius: so far off bends and joints put a tube's curvature.
constexpr double kSureOff = 0.05;

void keep_surest(std::vector<TubePiece>& pieces) {
  if (pieces.size() <= kMostPieces) return;
  std::ranges::stable_sort(pieces, std::greater<>(), &TubePiece::evidence);
  pieces.resize(kMostPieces);
}

struct ExaminedPiece {
  TubePiece piece;
  PieceEvidence evidence;
};

/// Short and with little evidence, or of a curvature that is a little off: it may be a bit of a tube of another radius.
struct UnsurePiece {
  TubePiece piece;
  double off = 0.0;  ///< curvature, in units of 1 / radius
};

/// What was found of a radius, before others are known.
struct PossibleClass {
  TubeClass sure;
  std::vector<UnsurePiece> unsure;
  double evidence = 0.0;     ///< nats, of its long pieces
  bool has_ground = false;   ///< most of what is not flat is no tube
  double typical_off = 0.0;  ///< the median of their curvatures' errors, in units of 1 / radius
};

/// The classes with those unsure pieces where no other class surely has a tube.
std::vector<TubeClass> settled(const std::vector<PossibleClass>& possible) {
  std::vector<TubeClass> classes;
  for (const PossibleClass& own : possible) {
    classes.push_back(own.sure);
    const auto is_other = [&](const UnsurePiece& unsure) {
      return std::ranges::any_of(possible, [&](const PossibleClass& other) {
        return &other != &own && std::ranges::any_of(other.sure.pieces, [&](const TubePiece& solid) {
          return is_inside(unsure.piece, solid);
        });
      });
    };
    for (const UnsurePiece& unsure : own.unsure)
      if (!is_other(unsure)) classes.back().pieces.push_back(unsure.piece);
    keep_surest(classes.back().pieces);
  }
  return classes;
}

class ClassFinder {
 public:
  ClassFinder(FilteredCloud& cloud, const ViewProjection& projection, const OcclusionTest& occlusion, double noise,
              bool background_is_known, const Vec3& up)
      : cloud_(cloud),
        projection_(projection),
        occlusion_(occlusion),
        noise_(noise),
        background_is_known_(background_is_known),
        up_(up) {}

  TubeClasses find_told(const std::vector<double>& radii) {
    for (const double radius : radii) {
      possible_.push_back(pieces_of(left(), radius));
      if (radii.size() > 1) set_aside(possible_.back().sure.pieces);
    }
    return {.classes = settled(possible_), .round = {}};
  }

  TubeClasses find_all() {
    std::vector<double> tried;
    PossibleClass weak;  // the likeliest of those that are not believed
    const std::size_t enough = cloud_.points.size() / 100;
    for (std::size_t k = 0; k < kMostTries && possible_.size() < kMostClasses; ++k) {
      if (rest_ && rest_->points.size() < enough) break;
      if (!possible_.empty() && sampled_ > kMostPoints) break;
      const double seen = likeliest_radius(left(), tried, enough);
      if (seen <= 0.0) break;
      PossibleClass found = refined_class(left(), seen, tried);
      tried.push_back(found.sure.radius > 0.0 ? found.sure.radius : seen);
      set_aside(standing_);
      if (is_believed(found)) {
        set_aside(found.sure.pieces);
        possible_.push_back(std::move(found));
      } else if (found.evidence > weak.evidence) {
        weak = std::move(found);
      }
    }
    if (possible_.empty() && weak.evidence > 0.0) possible_.push_back(std::move(weak));
    std::vector<TubeClass> classes = settled(possible_);
    for (TubeClass& found : classes) drop_streaks(found);
    std::erase_if(classes, [](const TubeClass& found) { return found.pieces.empty(); });
    return {.classes = std::move(classes), .round = std::move(round_)};
  }

 private:
  FilteredCloud& left() { return rest_ ? *rest_ : cloud_; }

  double reach(const FilteredCloud& cloud, double radius) const { return normal_radius(cloud.spacing, radius); }

  /// The radius that most places of the surface show, of those that are not `tried` yet; 0 where fewer than `enough`
  /// points show one.
  double likeliest_radius(FilteredCloud& cloud, const std::vector<double>& tried, std::size_t enough) {
    if (cloud.normals.empty()) add_normals(cloud, projection_, 0.0);
    CurvedPlaces places = find_curved_places(cloud.points, cloud.normals, projection_, cloud.spacing);
    if (!rest_) round_ = std::move(places.round);
    const CommonRadius common = commonest_radius(places.radii, tried);
    if (common.places < 10 || common.places * cloud.points.size() < enough * places.looked_at) return 0.0;
    return common.radius;
  }

  /// From the radius that places show to the one that the longest pieces show, and to all of its pieces. What tubes of a
  /// `tried` radius left over leads back to that one, and is not followed.
  PossibleClass refined_class(FilteredCloud& cloud, double radius, const std::vector<double>& tried) {
    for (int round = 0; round < 2; ++round) {
      // Where points are sparse, normals from as many as a known radius would not let in are too flat.
      if (reach(cloud, radius) < 0.9 * reach(cloud, round == 0 ? 0.0 : 2.0 * radius))
        cloud.normals = estimate_normals(projection_, cloud.points, reach(cloud, radius), 1, cloud.viewpoints);
      const double refined = refined_radius(cloud, radius, false);
      if (refined <= 0.0) return {};
      if (is_tried(refined, tried)) break;
      const bool is_settled = std::abs(refined - radius) < 0.05 * radius;
      radius = refined;
      if (is_settled) break;
    }
    PossibleClass found = pieces_of(cloud, radius);
    // The longest pieces may have been ground.
    const double refined = found.has_ground ? refined_radius(cloud, radius, true) : 0.0;
    if (refined > 0.0 && std::abs(refined - radius) > 0.01 * radius && !is_tried(refined, tried))
      found = pieces_of(cloud, refined);
    return found;
  }

  bool is_believed(const PossibleClass& found) const {
    const double share = possible_.empty() ? 0.0 : kFurtherShare * possible_.front().evidence;
    return found.evidence > std::max(kEnoughEvidence, share);
  }

  /// Points `apart` metres from each other, or farther where they would be too many.
  FilteredCloud sample_of(const FilteredCloud& cloud, double apart, double radius) const {
    const double share = static_cast<double>(cloud.points.size()) / kMostPoints;
    return thinned(cloud, std::max(apart, cloud.spacing * std::sqrt(share)), projection_, radius);
  }

  /// What is left where ground that is not flat has been taken away; all where the ground is known.
  FilteredCloud without_ground(FilteredCloud sample, double radius) const {
    return background_is_known_ ? std::move(sample) : without_sheets(sample, radius);
  }

  /// As the longest pieces that are tubes show it, `outlined`: of those with a tube's outline; 0 where none is.
  double refined_radius(const FilteredCloud& cloud, double radius, bool outlined) {
    const std::size_t kSegments = outlined ? 24 : 12, kPieces = 5;
    // A quarter of a radius apart, a stretch of tube still has some ten votes in a voxel of segment_by_votes.
    const FilteredCloud sample = without_ground(sample_of(cloud, radius / 4.0, radius), radius);
    auto segments = segment_by_votes(sample, radius);
    std::ranges::sort(segments, [](const Segment& a, const Segment& b) { return a.size() > b.size(); });
    if (segments.size() > kSegments) segments.resize(kSegments);
    const OcclusionTest occlusion = occlusion_.with_radius(radius);
    const auto round_ones = [&](std::vector<TubePiece> pieces) {
      std::vector<ExaminedPiece> round;
      for (TubePiece& piece : pieces) {
        const PieceEvidence evidence = examine_piece(piece, sample.points, occlusion);
        if (std::abs(evidence.curvature - 1.0) <= 0.4 && evidence.empty <= 0.3)
          round.push_back({std::move(piece), evidence});
      }
      return round;
    };
    const auto longest_piece = [&](const Segment& segment) {
      // Bends that are cut would make the radius too small.
      const VoteCurve curve =
          find_vote_curve(sample, std::move(split_branches(sample, segment, radius).front()), radius);
      const auto piece = fit_centerline(sample, curve, bend_tolerance({}, radius), {}, radius,
                                        viewpoint_of(sample, segment, projection_));
      return round_ones(piece ? std::vector{*piece} : std::vector<TubePiece>{});
    };
    std::vector<TubePiece> pieces;
    const auto add = [&](const std::vector<ExaminedPiece>& round) {
      for (const ExaminedPiece& found : round)
        if (!outlined || !goes_on_beside(found.evidence)) pieces.push_back(found.piece);
    };
    for (std::size_t next = 0; next < segments.size() && pieces.size() < kPieces;) {
      const std::size_t count = std::min(kPieces - pieces.size(), segments.size() - next);
      add(gather_in_parallel(count, [&](std::size_t k) { return longest_piece(segments[next + k]); }));
      next += count;
    }
    // A ring's surface is no one piece.
    if (pieces.empty()) add(round_ones(fit_segments(sample, segments, projection_, radius)));
    return pieces.empty() ? 0.0 : refine_radius(pieces, sample.points, radius);
  }

  /// Before a known background all but what other tubes leave over is tube.
  bool all_is_tube() const { return background_is_known_ && !rest_; }

  /// The pieces that are tube, and of the others what is. `outlined`: where their outlines show it.
  std::vector<ExaminedPiece> tubes_of(const std::vector<ExaminedPiece>& pieces, const FilteredCloud& sample,
                                      double radius, bool outlined) const {
    const OcclusionTest occlusion = occlusion_.with_radius(radius);
    const auto examine = [&](const TubePiece& piece) { return examine_piece(piece, sample.points, occlusion); };
    const auto shows_tube = [&](const PieceEvidence& evidence) {
      if (all_is_tube()) return !has_other_radius(evidence);
      return is_tube(evidence, radius, noise_) && !(outlined && goes_on_beside(evidence));
    };
    const auto is_tube_by_itself = [&](const TubePiece& piece) { return shows_tube(examine(piece)); };
    return gather_in_parallel(pieces.size(), [&](std::size_t k) {
      std::vector<ExaminedPiece> tubes;
      if (shows_tube(pieces[k].evidence)) {
        tubes.push_back(pieces[k]);
      } else if (!all_is_tube()) {
        for (TubePiece& stretch : tube_stretches(pieces[k].piece, sample.points, is_tube_by_itself))
          if (const PieceEvidence own = examine(stretch); shows_tube(own)) tubes.push_back({std::move(stretch), own});
      }
      return tubes;
    });
  }

  /// The part of all that is not flat which lies on tubes: earlier classes' and these, of a sample of `sampled` points of the rest.
  double tube_part(const std::vector<ExaminedPiece>& tubes, std::size_t sampled) {
    double on_tubes = 0.0;
    for (const ExaminedPiece& tube : tubes) on_tubes += static_cast<double>(tube.piece.points.size());
    const double rest = static_cast<double>(left().points.size()) / static_cast<double>(cloud_.points.size());
    return 1.0 - rest * (1.0 - on_tubes / static_cast<double>(std::max<std::size_t>(sampled, 1)));
  }

  /// Cloth, gravel and other rough ground is as round as a tube somewhere: what looks like one has to have a tube's outline there.
  std::vector<ExaminedPiece> tubes_in(FilteredCloud sample, double radius, bool& has_ground) {
    const std::size_t sampled = sample.points.size();
    const FilteredCloud searched = without_ground(std::move(sample), radius);
    std::vector<TubePiece> found =
        find_centerline_pieces(searched, segment_by_votes(searched, radius), projection_, radius);
    const OcclusionTest occlusion = occlusion_.with_radius(radius);
    const std::vector<ExaminedPiece> pieces = gather_in_parallel(found.size(), [&](std::size_t k) {
      const PieceEvidence evidence = examine_piece(found[k], searched.points, occlusion);
      return std::vector<ExaminedPiece>{{std::move(found[k]), evidence}};
    });
    std::vector<ExaminedPiece> tubes = tubes_of(pieces, searched, radius, false);
    // Ground that a believed radius leaves is ground to the next ones, whatever looks like tubes of theirs.
    has_ground = !background_is_known_ &&
                 (tube_part(tubes, sampled) < kMostlyTube || (!possible_.empty() && possible_.front().has_ground));
    if (has_ground) tubes = tubes_of(pieces, searched, radius, true);
    return tubes;
  }

  PossibleClass pieces_of(const FilteredCloud& cloud, double radius) {
    // Points that lie closer together cost time and add nothing: these make 24 votes a voxel of segment_by_votes.
    FilteredCloud sample = sample_of(cloud, radius / 6.0, radius);
    sampled_ += sample.points.size();
    PossibleClass found{.sure = {.radius = radius, .radius_error = 0.0, .pieces = {}}, .unsure = {}};
    double information = 0.0;
    std::vector<double> offs;
    for (auto& [piece, evidence] : tubes_in(std::move(sample), radius, found.has_ground)) {
      if (!all_is_tube() && stands_upright(piece, up_)) {
        standing_.push_back(std::move(piece));
        continue;
      }
      // Of two normal errors, the plane's is that many standard deviations.
      const double deviations = evidence.curvature / evidence.curvature_error;
      piece.evidence = 0.5 * deviations * deviations;
      information += 1.0 / (evidence.curvature_error * evidence.curvature_error);
      const double off = std::abs(evidence.curvature - 1.0);
      if (piece.length() >= kShort * radius) {
        offs.push_back(off);
        if (!is_known(piece, off)) found.evidence += piece.evidence;
      }
      if (is_doubtful(piece.length(), radius, piece.evidence) || off > kSureOff + 2.0 * evidence.curvature_error)
        found.unsure.push_back({std::move(piece), off});
      else found.sure.pieces.push_back(std::move(piece));
    }
    if (information > 0.0) found.sure.radius_error = radius / std::sqrt(information);
    if (!offs.empty()) found.typical_off = median(offs);
    return found;
  }

  /// Whether it fits hardly better than an unsure piece of an earlier class in its place, as far as curvatures can be trusted:
  /// real scans blur them by more than their points scatter.
  bool is_known(const TubePiece& piece, double off) const {
    return std::ranges::any_of(possible_, [&](const PossibleClass& other) {
      return std::ranges::any_of(other.unsure, [&](const UnsurePiece& unsure) {
        return unsure.off < 2.0 * off + 4.0 * other.typical_off && is_inside(piece, unsure.piece);
      });
    });
  }

  /// A streak of a bottle's side may look like a tube of a smaller radius.
  void drop_streaks(TubeClass& found) const {
    std::erase_if(found.pieces, [&](const TubePiece& piece) {
      return std::ranges::any_of(standing_, [&](const TubePiece& solid) { return is_inside(piece, solid); });
    });
  }

  /// What the pieces do not explain is left for others.
  void set_aside(const std::vector<TubePiece>& pieces) {
    if (pieces.empty()) return;
    FilteredCloud rest{.source = {}, .points = {}, .normals = {}, .spacing = cloud_.spacing};
    for (const std::uint32_t i : unexplained_points(left().points, pieces, cloud_.spacing)) {
      rest.source.push_back(left().source[i]);
      rest.points.push_back(left().points[i]);
    }
    rest_ = std::move(rest);
  }

  FilteredCloud& cloud_;
  const ViewProjection& projection_;
  const OcclusionTest& occlusion_;
  double noise_;
  bool background_is_known_;
  Vec3 up_;
  std::size_t sampled_ = 0;  ///< points, of all tries
  std::optional<FilteredCloud> rest_;
  std::vector<RoundPlace> round_;
  std::vector<TubePiece> standing_;
  std::vector<PossibleClass> possible_;  ///< of the radii so far
};

}  // namespace

TubeClasses find_tube_classes(FilteredCloud& cloud, const ViewProjection& projection, const OcclusionTest& occlusion,
                              double noise, bool background_is_known, const Vec3& up, const std::vector<double>& told) {
  ClassFinder finder(cloud, projection, occlusion, noise, background_is_known, up);
  return told.empty() ? finder.find_all() : finder.find_told(told);
}

}  // namespace tubebin::modeling
