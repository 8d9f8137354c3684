/// The tubes' radius where nobody states it.
#pragma once

#include <vector>

#include "modeling/input/normals.hpp"
#include "tubebin/modeling/tube_model.hpp"

namespace tubebin::modeling {

/// A place of a surface that curves alike in all directions, and the ball that it may be of; metres.
struct RoundPlace {
  Vec3 center;
  double radius = 0.0;
};

/// A place of a surface that curves as a cylinder does: its normals turn by 1 / r a metre across the axis and not at all along it.
struct TubularPlace {
  double radius = 0.0;  ///< metres
  Vec3 center;          ///< on the axis
  Vec3 axis;            ///< unit
};

/// Places spread over the surface, by how it curves there.
struct CurvedPlaces {
  std::vector<TubularPlace> tubular;
  std::vector<RoundPlace> round;
  std::size_t hollow = 0;  ///< that curve like the inside of a cylinder
  std::size_t looked_at = 0;
};
/// Some hundred show what is common.
constexpr std::size_t kSomePlaces = 600;
/// Looks at `count` places at most.
CurvedPlaces find_curved_places(const FilteredCloud& cloud, const SurfaceNormals& surface, std::size_t count);

/// A radius, metres, and how many places show it.
struct CommonRadius {
  double radius = 0.0;
  std::size_t places = 0;
};
/// Whether it is nearer than a seventh to one of the `tried` radii, which then count as the same.
bool is_tried(double radius, const std::vector<double>& tried);

/// The one that most places show, within a quarter, none of the `tried` ones.
CommonRadius commonest_radius(const std::vector<TubularPlace>& places, const std::vector<double>& tried);

/// The median radius of the circles that fit the points about the pieces' cylinders, seen along their axes (Kasa
/// 1976), metres; `radius` where no cylinder is long enough to tell.
double refine_radius(const std::vector<TubePiece>& pieces, const std::vector<cloud::Point>& points, double radius);

}  // namespace tubebin::modeling
