/// What the scan says about stretches of tube that it did not see.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "modeling/input/flat_regions.hpp"
#include "tubebin/modeling/modeling_input.hpp"
#include "tubebin/modeling/scan_view.hpp"

namespace tubebin::modeling {

/// How the places that a stretch of tube would take up look in the scan, each as a part of 1.
struct StretchEvidence {
  double hidden = 0.0;   ///< behind something nearer to the scanner, or in a gap of the scan: a tube may be there
  double surface = 0.0;  ///< at a measured surface: a tube may be there, or what was measured is another's
  double empty = 0.0;    ///< seen through, or inside a solid: no tube is there
  double no_data = 0.0;  ///< where the scanner measured nothing at all
};

/// How the scan goes on at the two sides of a tube, each as a part of 1.
struct OutlineEvidence {
  double edge = 0.0;   ///< just beside the tube, seen past it to what lies over half a radius lower than its axis
  double level = 0.0;  ///< just beside the tube, a surface not lower than that, as about a rib that is part of a floor
  double flat = 0.0;   ///< at its flank, a surface up to a radius in front of it, as of what is less curved
};

class OcclusionTest {
 public:
  /// `spacing`: metres between neighbouring points of the whole input at their median range; of a merged cloud each
  /// scanner's points show its own. `projection`: of the first scanner.
  OcclusionTest(const ModelingInput& input, const ViewProjection& projection, double spacing, double radius);
  /// Regions with nothing behind them: no tube is there either.
  void add_solids(std::vector<FlatRegion> regions) { solids_ = std::move(regions); }
  /// The same scan, for tubes of another radius.
  OcclusionTest with_radius(double radius) const;

  /// Of a tube's surface about one point of its centreline, over the middle of its visible width.
  StretchEvidence around(const Vec3& center, const Vec3& direction) const;
  /// Of the sides of a tube about one point of its centreline, where they are in sight.
  StretchEvidence sides(const Vec3& center, const Vec3& direction) const;
  /// How its outline about one point of its centreline looks.
  OutlineEvidence outline(const Vec3& center, const Vec3& direction) const;
  /// What the scanners that face a place of a surface saw there, to a quarter of a radius; outside where none does. `normal` is
  /// unit.
  RangeImage::Evidence facing(const Vec3& place, const Vec3& normal) const;
  /// The part of a centreline, sampled at its steps, where the scan shows that no tube is. Summed up until it is
  /// `enough`, a part of 1, to rule the whole out.
  double empty_part(const std::vector<Vec3>& curve, double enough) const;
  /// How far a tube could go on straight from `end` without being seen, metres, at most `limit`.
  double hidden_reach(const Vec3& end, const Vec3& outward, double limit) const;

 private:
  /// Of a place beside the centreline as a scanner sees it, radii: to the right, and towards the scanner.
  using Place = Eigen::Vector2d;
  /// What was measured within `tolerance` radii of a place, across the tube, counts as surface.
  StretchEvidence evidence_at(const Vec3& center, const Vec3& direction, std::span<const Place> places,
                              double tolerance) const;
  /// At the surface, so many radii to the right.
  StretchEvidence evidence_across(const Vec3& center, const Vec3& direction, std::span<const double> across) const;
  bool in_solid(const Vec3& point) const;

  /// The scan as one of the scanners saw it.
  struct View {
    Vec3 viewpoint;
    RangeImage image;
    double cell;  ///< radians
  };
  static std::vector<View> views(const ModelingInput& input, const ViewProjection& projection, double spacing);

  double radius_;
  std::shared_ptr<const std::vector<View>> views_;
  std::optional<scene::Bin> bin_;
  std::vector<scene::InnerFace> bin_faces_;
  std::vector<FlatRegion> solids_;
  Pose bin_from_world_;
};

}  // namespace tubebin::modeling
