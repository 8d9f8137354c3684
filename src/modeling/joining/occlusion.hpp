/// What the scan says about stretches of tube that it did not see.
#pragma once

#include <optional>
#include <vector>

#include "tubebin/modeling/modeling_input.hpp"
#include "tubebin/modeling/scan_view.hpp"

namespace tubebin::modeling {

/// How the places that a stretch of tube would take up look in the scan, each as a part of 1.
struct StretchEvidence {
  double hidden = 0.0;   ///< behind something nearer to the scanner: a tube may be there
  double surface = 0.0;  ///< at a measured surface: a tube may be there, or what was measured is another's
  double empty = 0.0;    ///< seen through, or inside the bin's solids: no tube is there
};

class OcclusionTest {
 public:
  /// `spacing`: metres between neighbouring points of the whole input.
  OcclusionTest(const ModelingInput& input, const ViewProjection& projection, double spacing, double radius);

  /// Of a tube's surface about one point of its centreline, over the middle of its visible width.
  StretchEvidence around(const Vec3& center, const Vec3& direction) const;
  /// The part of a centreline, sampled at its steps, where the scan shows that no tube is. Summed up until it is
  /// `enough`, a part of 1, to rule the whole out.
  double empty_part(const std::vector<Vec3>& curve, double enough) const;
  /// How far a tube could go on straight from `end` without being seen, metres, at most `limit`.
  double hidden_reach(const Vec3& end, const Vec3& outward, double limit) const;

 private:
  bool in_bin_solid(const Vec3& point) const;

  Vec3 viewpoint_;
  double radius_;
  RangeImage image_;
  std::optional<scene::Bin> bin_;
  Pose bin_from_world_;
};

}  // namespace tubebin::modeling
