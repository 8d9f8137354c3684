/// Circles and spheres through points.
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <vector>

namespace tubebin::modeling {

/// Of as many dimensions as its points; metres.
template <int Dimensions>
struct FittedSphere {
  Eigen::Vector<double, Dimensions> center;
  double radius = 0.0;
  double radius_variance = 0.0;  ///< as the points' scatter tells it; a narrow cap says little of its radius
};

/// The sphere from which the points' distances have the least squares: Gauss-Newton from `start`. (The algebraic fit, which is
/// linear, makes spheres too small where there is noise.)
template <int Dimensions>
FittedSphere<Dimensions> fit_sphere(const std::vector<Eigen::Vector<double, Dimensions>>& points,
                                    FittedSphere<Dimensions> start) {
  constexpr int kSteps = 4, kUnknowns = Dimensions + 1;
  using Vector = Eigen::Vector<double, kUnknowns>;
  FittedSphere<Dimensions> sphere = start;
  for (int step = 0; step < kSteps; ++step) {
    Eigen::Matrix<double, kUnknowns, kUnknowns> normal_matrix = Eigen::Matrix<double, kUnknowns, kUnknowns>::Zero();
    Vector right = Vector::Zero();
    double squares = 0.0;
    for (const auto& point : points) {
      const Eigen::Vector<double, Dimensions> offset = point - sphere.center;
      const double distance = std::max(offset.norm(), 1e-12), residual = distance - sphere.radius;
      const Vector row = (offset / distance).homogeneous();
      normal_matrix += row * row.transpose();
      right += residual * row;
      squares += residual * residual;
    }
    const auto factors = normal_matrix.ldlt();
    const Vector change = factors.solve(right);
    sphere.center += change.template head<Dimensions>();
    sphere.radius += change[Dimensions];
    sphere.radius_variance =
        squares / static_cast<double>(points.size()) * factors.solve(Vector::Unit(Dimensions))[Dimensions];
  }
  return sphere;
}

}  // namespace tubebin::modeling
