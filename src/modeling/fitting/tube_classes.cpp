#include "modeling/fitting/tube_classes.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "modeling/fitting/centerline_pieces.hpp"
#include "modeling/fitting/centerline_segmentation.hpp"
#include "modeling/fitting/piece_cleaning.hpp"
#include "modeling/fitting/piece_evidence.hpp"
#include "modeling/fitting/possible_classes.hpp"
#include "modeling/fitting/radius_refining.hpp"
#include "modeling/fitting/rough_ground.hpp"
#include "modeling/fitting/tube_stretches.hpp"
#include "modeling/fitting/vote_sheets.hpp"
#include "modeling/fitting/wire_mesh.hpp"
#include "modeling/input/normals.hpp"
#include "modeling/input/point_sample.hpp"
#include "modeling/input/radius_estimation.hpp"
#include "modeling/median.hpp"
#include "modeling/parallel.hpp"

namespace tubebin::modeling {
namespace {

constexpr std::size_t kMostClasses = 4, kMostTries = 8;

/// A hundred tubes, forty radii long and seen from end to end, have as many a sixth of a radius apart.
constexpr std::size_t kMostPoints = 300'000;

/// In nats, of a radius' long pieces. Edges and rims seem round here and there, and of no one radius: up to 8000 on crumpled ground;
/// ten tubes have 200,000 and more. Less is believed where no radius has as much.
constexpr double kEnoughEvidence = 20'000.0;
/// And of a further radius as a part of the first one's: where tubes branch or touch, some surface is as round as a thicker tube.
constexpr double kFurtherShare = 0.01;

/// In units of 1 / radius: so far off bends and joints put a tube's curvature.
constexpr double kSureOff = 0.05;

struct ExaminedPiece {
  TubePiece piece;
  PieceEvidence evidence;
};

/// What is looked through for tubes of a radius, and where their centrelines may be.
struct Search {
  FilteredCloud sample;
  SegmentCurves curves;
  bool has_ground = false;  ///< that is rough, and whose curves were left out
};

class ClassFinder {
 public:
  ClassFinder(const FilteredCloud& cloud, const ViewProjection& projection, const OcclusionTest& occlusion,
              double noise, bool background_is_known, const Vec3& up)
      : cloud_(cloud),
        projection_(projection),
        occlusion_(occlusion),
        noise_(noise),
        background_is_known_(background_is_known),
        up_(up) {}

  TubeClasses find_told(const std::vector<double>& radii) {
    radii_are_told_ = true;
    for (const double radius : radii) {
      estimate_normals(radius);
      possible_.push_back(pieces_of(search(radius), radius));
      is_rough_ = is_rough_ || possible_.back().has_ground;
      if (radii.size() > 1) set_aside(possible_.back().sure.pieces);
    }
    return {.classes = settled(possible_, cloud_.spacing), .wires = {}, .round = {}, .on_rough_ground = is_rough_};
  }

  TubeClasses find_all() {
    std::vector<double> tried;
    PossibleClass weak;  // the likeliest of those that are not believed
    const std::size_t enough = cloud_.points.size() / 100;
    for (std::size_t k = 0; k < kMostTries && possible_.size() < kMostClasses; ++k) {
      if (rest_ && rest_->points.size() < enough) break;
      const double seen = likeliest_radius(tried, enough);
      if (seen <= 0.0) break;
      PossibleClass found = refined_class(seen, tried);
      is_rough_ = is_rough_ || found.has_ground || (found.sure.radius <= 0.0 && much_is_left(seen));
      tried.push_back(found.sure.radius > 0.0 ? found.sure.radius : seen);
      set_aside(solids_);
      if (is_believed(found)) {
        set_aside(found.sure.pieces);
        if (!background_is_known_ && are_sunk(found.outline))
          std::ranges::move(found.sure.pieces, std::back_inserter(solids_));
        else if (is_wire_mesh(found.sure.pieces)) std::ranges::move(found.sure.pieces, std::back_inserter(wires_));
        else possible_.push_back(std::move(found));
      } else if (weak_evidence(found) > weak_evidence(weak)) {
        weak = std::move(found);
      }
    }
    if (possible_.empty() && weak_evidence(weak) > 0.0) possible_.push_back(std::move(weak));
    std::vector<TubeClass> classes = settled(possible_, cloud_.spacing);
    for (TubeClass& found : classes) drop_streaks(found);
    std::erase_if(classes, [](const TubeClass& found) { return found.pieces.empty(); });
    return {.classes = std::move(classes),
            .wires = std::move(wires_),
            .round = std::move(round_),
            .on_rough_ground = is_rough_};
  }

 private:
  const FilteredCloud& left() const { return rest_ ? *rest_ : cloud_; }

  /// Metres, of normals of what is left. `radius`: of the tubes; 0 where it is not known.
  double reach(double radius) const { return normal_radius(left().spacing, radius); }

  void estimate_normals(double radius) { normals_.emplace(left(), projection_, reach(radius)); }

  /// The radius that most places of the surface show, of those that are not `tried` yet; 0 where fewer than `enough`
  /// points show one. On rough ground places with a tube's outline count alone.
  double likeliest_radius(const std::vector<double>& tried, std::size_t enough) {
    constexpr std::size_t kManyPlaces = 10 * kSomePlaces, kFew = 10;
    if (!normals_) estimate_normals(0.0);
    CurvedPlaces places = find_curved_places(left(), *normals_, is_rough_ ? kManyPlaces : kSomePlaces);
    if (!rest_) round_ = std::move(places.round);
    const CommonRadius common =
        commonest_radius(is_rough_ ? with_outline(std::move(places.tubular)) : places.tubular, tried);
    if (common.places < kFew) return 0.0;
    if (!is_rough_ && common.places * left().points.size() < enough * places.looked_at) return 0.0;
    return common.radius;
  }

  /// Whether more is left than tubes of the radius show where little else is, as before a known background.
  bool much_is_left(double radius) const {
    if (background_is_known_) return false;
    const double thinner = left().spacing / std::max(radius / 6.0, left().spacing);
    return thinner * thinner * static_cast<double>(left().points.size()) > kPointsOfGround;
  }

  /// The places on both sides of which the surface ends as a tube's does.
  std::vector<TubularPlace> with_outline(std::vector<TubularPlace> places) const {
    std::erase_if(places, [&](const TubularPlace& place) {
      const OutlineEvidence outline = occlusion_.with_radius(place.radius).outline(place.center, place.axis);
      return outline.edge < 1.0 || outline.flat > 0.0;
    });
    return places;
  }

  /// From the radius that places show to the one that the longest pieces show, and to all of its pieces. What tubes of a
  /// `tried` radius left over leads back to that one, and is not followed.
  PossibleClass refined_class(double seen, const std::vector<double>& tried) {
    double radius = seen;
    for (int round = 0; round < 2; ++round) {
      // Where points are sparse, normals from as many as a known radius would not let in are too flat.
      if (reach(radius) < 0.9 * reach(round == 0 ? 0.0 : 2.0 * radius)) estimate_normals(radius);
      // A quarter of a radius apart, a stretch of tube still has some ten votes in a voxel of segment_by_votes.
      const FilteredCloud sample = without_ground(sample_of_left(radius / 4.0), radius);
      const double refined = refined_radius(sample, radius, projection_, occlusion_.with_radius(radius));
      if (refined <= 0.0) return {};
      if (is_tried(refined, tried)) break;
      const bool is_settled = std::abs(refined - radius) < 0.05 * radius;
      radius = refined;
      if (is_settled) break;
    }
    Search found = search(radius);
    if (!found.has_ground) return pieces_of(std::move(found), radius);
    // The longest pieces may have been ground, and the radius as well.
    for (const double guess : {radius, seen}) {
      if (guess != radius) found = search(guess);
      const double own =
          radius_along(found.curves.curves, found.sample, guess, projection_, occlusion_.with_radius(guess));
      if (own <= 0.0) continue;
      if (std::abs(own - guess) > 0.01 * guess) return pieces_of(search(own), own);
      return pieces_of(std::move(found), guess);
    }
    return {};
  }

  /// Of a class that is not believed, nats. Edges and rims look round in bits; where the background is known, all that is round counts.
  double weak_evidence(const PossibleClass& found) const {
    if (!background_is_known_) return found.unsure.size() < found.sure.pieces.size() ? found.evidence : 0.0;
    double evidence = 0.0;
    for (const TubePiece& piece : found.sure.pieces) evidence += piece.evidence;
    for (const UnsurePiece& unsure : found.unsure) evidence += unsure.piece.evidence;
    return evidence;
  }

  bool is_believed(const PossibleClass& found) const {
    const double share = possible_.empty() ? 0.0 : kFurtherShare * possible_.front().evidence;
    return found.evidence > std::max(kEnoughEvidence, share);
  }

  /// Points of what is left, `apart` metres from each other, or farther where they would be too many.
  FilteredCloud sample_of_left(double apart) const {
    const double share = static_cast<double>(left().points.size()) / kMostPoints;
    return thinned(left(), std::max(apart, left().spacing * std::sqrt(share)), *normals_);
  }

  /// What is left where ground that is not flat has been taken away; all where the ground is known.
  FilteredCloud without_ground(FilteredCloud sample, double radius) const {
    return background_is_known_ ? std::move(sample) : without_sheets(sample, radius);
  }

  /// Before a known background all but what other tubes leave over is tube.
  bool all_is_tube() const { return background_is_known_ && !rest_; }

  /// The pieces that are tube, and of the others what is. `outlined`: where their outlines do not speak against it.
  std::vector<ExaminedPiece> tubes_of(const std::vector<TubePiece>& pieces, const FilteredCloud& sample, double radius,
                                      bool outlined) const {
    const OcclusionTest occlusion = occlusion_.with_radius(radius);
    const auto examine = [&](const TubePiece& piece) { return examine_piece(piece, sample, occlusion); };
    const auto shows_tube = [&](const PieceEvidence& evidence) {
      if (all_is_tube()) return !has_other_radius(evidence);
      return is_tube(evidence, radius, noise_) && !(outlined && goes_on_beside(evidence.outline));
    };
    const auto is_tube_by_itself = [&](const TubePiece& piece) { return shows_tube(examine(piece)); };
    return gather_in_parallel(pieces.size(), [&](std::size_t k) {
      std::vector<ExaminedPiece> tubes;
      if (const PieceEvidence evidence = examine(pieces[k]); shows_tube(evidence)) {
        tubes.push_back({pieces[k], evidence});
      } else if (!all_is_tube()) {
        for (TubePiece& stretch : tube_stretches(pieces[k], sample.points, is_tube_by_itself))
          if (const PieceEvidence own = examine(stretch); shows_tube(own)) tubes.push_back({std::move(stretch), own});
      }
      return tubes;
    });
  }

  Search search(double radius) {
    // Points that lie closer together cost time and add nothing: these make 24 votes a voxel of segment_by_votes.
    FilteredCloud sample = sample_of_left(radius / 6.0);
    const std::size_t sampled = sample.points.size();
    Search search{.sample = without_ground(std::move(sample), radius), .curves = {}};
    search.curves = find_curves(search.sample, segment_by_votes(search.sample, radius), radius);
    search.has_ground = !background_is_known_ &&
                        drop_rough_ground(search.curves.curves, sampled, radius, occlusion_.with_radius(radius));
    return search;
  }

  PossibleClass pieces_of(Search search, double radius) {
    const auto& [sample, curves, has_ground] = search;
    const OcclusionTest occlusion = occlusion_.with_radius(radius);
    const std::vector<TubePiece> pieces =
        find_centerline_pieces(sample, curves, projection_, radius, [&](std::vector<VoteCurve>& further) {
          if (search.has_ground) drop_ground(further, find_ground(further, radius, occlusion));
        });
    PossibleClass found{
        .sure = {.radius = radius, .radius_error = 0.0, .pieces = {}}, .unsure = {}, .has_ground = has_ground};
    double information = 0.0;
    std::vector<double> offs;
    std::vector<TubePiece> upright;
    std::vector<ExaminedPiece> tubes = tubes_of(pieces, sample, radius, has_ground);
    const std::vector<Vec3> ends = ends_of_leaning(tubes);
    found.outline = mean_outline(tubes);
    for (auto& [piece, evidence] : tubes) {
      // Of two normal errors, the plane's is that many standard deviations.
      const double deviations = evidence.curvature / evidence.curvature_error;
      piece.evidence = 0.5 * deviations * deviations;
      const bool is_unsure = is_doubtful(piece.length(), radius, piece.evidence) || !is_tube(evidence, radius, noise_);
      const double off = std::abs(evidence.curvature - 1.0);
      const bool has_radius = off <= kSureOff + 2.0 * evidence.curvature_error;
      if (!all_is_tube() && stands_upright(piece, up_) && !goes_on(piece, ends)) {
        if (!is_unsure) (has_radius ? upright : solids_).push_back(std::move(piece));
        continue;
      }
      information += 1.0 / (evidence.curvature_error * evidence.curvature_error);
      if (piece.length() >= kShort * radius) {
        offs.push_back(off);
        if (!is_known(piece, off, possible_)) found.evidence += piece.evidence;
      }
      if (is_unsure || !has_radius)
        found.unsure.push_back({.piece = piece, .off = off, .points = points_at(sample.points, piece.points)});
      else found.sure.pieces.push_back(std::move(piece));
    }
    // A bottle or a column has a radius of its own: what stands among tubes of its radius is one of them.
    std::vector<TubePiece>& kept_as = radii_are_told_ || is_believed(found) ? found.sure.pieces : solids_;
    std::ranges::move(upright, std::back_inserter(kept_as));
    if (information > 0.0) found.sure.radius_error = radius / std::sqrt(information);
    if (!offs.empty()) found.typical_off = median(offs);
    return found;
  }

  /// Both ends of each piece that does not stand.
  std::vector<Vec3> ends_of_leaning(const std::vector<ExaminedPiece>& tubes) const {
    std::vector<Vec3> ends;
    for (const auto& [piece, evidence] : tubes)
      if (!stands_upright(piece, up_)) ends.insert(ends.end(), {piece.nodes.front(), piece.nodes.back()});
    return ends;
  }

  /// Beside all of the pieces.
  static OutlineEvidence mean_outline(const std::vector<ExaminedPiece>& tubes) {
    OutlineEvidence mean;
    double length = 0.0;
    for (const auto& [piece, evidence] : tubes) {
      length += piece.length();
      mean.edge += piece.length() * evidence.outline.edge;
      mean.level += piece.length() * evidence.outline.level;
    }
    for (double* part : {&mean.edge, &mean.level}) *part /= std::max(length, 1e-9);
    return mean;
  }

  /// A streak of a bottle's side may look like a tube of a smaller radius.
  void drop_streaks(TubeClass& found) const {
    std::erase_if(found.pieces, [&](const TubePiece& piece) {
      return std::ranges::any_of(solids_, [&](const TubePiece& solid) { return is_inside(piece, solid); });
    });
  }

  /// What the pieces do not explain is left for others.
  void set_aside(const std::vector<TubePiece>& pieces) {
    if (pieces.empty()) return;
    rest_ = without_pieces(left(), pieces);
    normals_.reset();
  }

  const FilteredCloud& cloud_;
  const ViewProjection& projection_;
  const OcclusionTest& occlusion_;
  double noise_;
  bool background_is_known_;
  Vec3 up_;
  bool radii_are_told_ = false;
  bool is_rough_ = false;  ///< some of the ground, which shows all radii
  std::optional<FilteredCloud> rest_;
  std::optional<SurfaceNormals> normals_;  ///< of what is left
  std::vector<RoundPlace> round_;
  std::vector<TubePiece> solids_;  ///< that are no tubes: what stands, and what is sunk in its surroundings
  std::vector<TubePiece> wires_;
  std::vector<PossibleClass> possible_;  ///< of the radii so far
};

}  // namespace

TubeClasses find_tube_classes(const FilteredCloud& cloud, const ViewProjection& projection,
                              const OcclusionTest& occlusion, double noise, bool background_is_known, const Vec3& up,
                              const std::vector<double>& told) {
  ClassFinder finder(cloud, projection, occlusion, noise, background_is_known, up);
  return told.empty() ? finder.find_all() : finder.find_told(told);
}

}  // namespace tubebin::modeling
