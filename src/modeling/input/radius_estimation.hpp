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

/// Radii of curvature at places spread over the surface, metres: on a cylinder, normals turn by 1 / r a metre across the
/// axis and not at all along it. Places where the surface does not curve that way have none.
struct CurvedPlaces {
  std::vector<double> radii;
  std::vector<RoundPlace> round;
  std::size_t hollow = 0;  ///< that curve like the inside of a cylinder
  std::size_t looked_at = 0;
};
CurvedPlaces find_curved_places(const FilteredCloud& cloud, const SurfaceNormals& surface);

/// A radius, metres, and how many places show it.
struct CommonRadius {
  double radius = 0.0;
  std::size_t places = 0;
};
/// Whether it is nearer than a seventh to one of the `tried` radii, which then count as the same.
bool is_tried(double radius, const std::vector<double>& tried);

/// The one that most places show, within a quarter, none of the `tried` ones.
CommonRadius commonest_radius(std::vector<double> radii, const std::vector<double>& tried);

/// The median radius of the circles that fit the points about the pieces' cylinders, seen along their axes (Kasa
/// 1976), metres; `radius` where no cylinder is long enough to tell.
double refine_radius(const std::vector<TubePiece>& pieces, const std::vector<cloud::Point>& points, double radius);

}  // namespace tubebin::modeling
