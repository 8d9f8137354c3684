/// Joining of tubes that are bent alike: the pieces that one copy of their shape explains are one tube's.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "modeling/joining/occlusion.hpp"
#include "modeling/joining/shape_copies.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

struct ShapeJoining {
  std::vector<TubePath> paths;  ///< of the copies: what pieces show of them, and their own course between, bridged
  std::vector<TubePiece> rest;  ///< what no copy explains
  double explained = 0.0;       ///< part of the pieces' length that the copies explain
  /// nats, how much likelier copies make the scene than a tube for each piece does; before copies were chosen nothing is
  double gain = -std::numeric_limits<double>::infinity();
  std::vector<double> lengths;  ///< of the shapes, metres
};

/// Where copies of `shapes`, centrelines by samples every half radius, explain pieces, of which there is at least one; nowhere
/// where they leave more than a part of 1 - `least_explained` of these. Keeps references to the shapes.
class ShapeSearch {
 public:
  ShapeSearch(const std::vector<TubePiece>& pieces, std::span<const std::vector<Vec3>> shapes,
              const OcclusionTest& occlusion, double least_explained);

  /// Chooses the copies of the shapes with these indices that explain the pieces best: each piece, or its part between two
  /// sharp bends, in one copy.
  ShapeJoining join(std::span<const std::size_t> chosen) const;

 private:
  std::span<const std::vector<Vec3>> shapes_;
  double radius_;
  double cost_alone_;  ///< nats, of a tube for each piece
  std::vector<Section> sections_;
  std::vector<std::vector<ShapeCopy>> copies_;  ///< of each shape
};

/// The same with all of the shapes.
ShapeJoining join_by_shapes(const std::vector<TubePiece>& pieces, std::span<const std::vector<Vec3>> shapes,
                            const OcclusionTest& occlusion);

}  // namespace tubebin::modeling
