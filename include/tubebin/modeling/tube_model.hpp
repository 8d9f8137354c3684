/// What the stages of both methods pass on, and what modeling results in.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "tubebin/cloud/cloud.hpp"

namespace tubebin::modeling {

/// Indices of the filtered cloud's points that one segment (cluster) holds.
using Segment = std::vector<std::uint32_t>;

/// A stretch of a tube as fitted to one segment: consecutive cylinders along a polyline.
struct TubePiece {
  std::vector<Vec3> nodes;  ///< metres, world frame; at least two, but of a ball one
  double radius = 0.0;      ///< metres
  Segment points;           ///< that it was fitted to
  double evidence = 0.0;    ///< nats: log of how much likelier its points are of a tube than of a flat strip

  double length() const;
};

/// Cylinders in a row, a joint between consecutive ones.
struct TubePath {
  std::vector<Vec3>
      nodes;  ///< cylinder i reaches from nodes[i] to nodes[i + 1]; metres, world frame; a ball's centre alone
  std::vector<bool> bridged;  ///< of cylinder i: it spans a stretch without points, from one piece to the next
  /// nats, of the bridges in order: log of how much likelier the best explanation of the scan is than the best one in
  /// which the pieces on both sides are different tubes'; 10 at most. Of a bridge to the disc of an end, how often such are
  /// right. None where this was not looked at.
  std::vector<double> bridge_odds = {};
  /// nats: the same against the best one in which its pieces are not one tube by themselves.
  std::optional<double> whole_odds = {};
  double evidence = 0.0;  ///< nats: log of how much likelier its points are of a tube than of flat strips
};

/// Turns the path about: its first end becomes its last.
void turn_about(TubePath& path);

/// A tube: one path, or, where it branches, a tree of them. A branch starts on the centreline of a path before it, or
/// ends there.
struct TubeModel {
  std::vector<TubePath> paths;            ///< longest first
  double radius = 0.0;                    ///< metres
  std::optional<double> whole_odds = {};  ///< nats: as TubePath::whole_odds, of all paths together

  double length() const;
  std::size_t cylinder_count() const;
  bool is_ball() const { return cylinder_count() == 0; }
};

/// A length or coordinate as model.json has it: to a tenth of a micrometre, below what a scanner tells, and short.
double rounded(double metres);

/// Nodes and radii as model.json has them, so that labels follow from the file.
void round_tubes(std::vector<TubeModel>& tubes);

/// Sum of the distances of consecutive nodes, metres.
double polyline_length(const std::vector<Vec3>& nodes);

/// The largest distance of consecutive nodes, metres.
double longest_step(const std::vector<Vec3>& nodes);

/// The box that holds the nodes of a polyline.
Eigen::AlignedBox3d box_of(std::span<const Vec3> nodes);

/// The place of a polyline that is nearest to a point.
Vec3 nearest_on_polyline(const Vec3& point, std::span<const Vec3> nodes);

/// Distance of a point to the nearest place of a polyline, metres.
double distance_to_polyline(const Vec3& point, std::span<const Vec3> nodes);

}  // namespace tubebin::modeling
