#include "modeling/input/grid_viewpoint.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "modeling/input/point_sample.hpp"

namespace tubebin::modeling {
namespace {

/// A measured point and its pixel, in widths of the picture from its corner.
struct Sample {
  Vec3 point;
  Eigen::Vector2d pixel;
};

/// A thousand of the points, those of them that were measured, evenly spread.
std::vector<Sample> sample_grid(std::span<const cloud::Point> points, std::uint32_t width) {
  constexpr std::size_t kSamples = 1000;
  std::vector<Sample> samples;
  for (std::size_t k = 0; k < kSamples; ++k) {
    // Steps of the golden ratio meet all rows and columns.
    const auto i = static_cast<std::size_t>(std::fmod(0.6180339887498949 * static_cast<double>(k), 1.0) *
                                            static_cast<double>(points.size()));
    if (!cloud::is_finite(points[i])) continue;
    const std::size_t row = i / width, column = i % width;
    samples.push_back(
        {.point = points[i].cast<double>(), .pixel = Eigen::Vector2d(double(column), double(row)) / double(width)});
  }
  return samples;
}

// Direct linear transform (Hartley and Zisserman 2004, "Multiple View Geometry", 7.1): the camera matrix P with pixel ~ P
// point is the direction in which the equations have the least squares; its null vector is where the camera stands.
std::optional<Vec3> viewpoint_of(const std::vector<Sample>& samples, std::uint32_t width) {
  constexpr std::size_t kFewest = 100;
  constexpr double kWorstPixels = 2.0;
  if (samples.size() < kFewest) return std::nullopt;
  const Vec3 middle = middle_of(samples, &Sample::point);
  double spread = 0.0;
  for (const Sample& sample : samples) spread += (sample.point - middle).norm();
  spread /= static_cast<double>(samples.size());

  using Row = Eigen::Matrix<double, 12, 1>;
  Eigen::Matrix<double, 12, 12> squares = Eigen::Matrix<double, 12, 12>::Zero();
  std::vector<Eigen::Vector4d> places;
  for (const Sample& sample : samples) {
    const Eigen::Vector4d place = ((sample.point - middle) / spread).homogeneous();
    places.push_back(place);
    for (int axis = 0; axis < 2; ++axis) {
      Row row = Row::Zero();
      row.segment<4>(4 * axis) = place;
      row.tail<4>() = -sample.pixel(axis) * place;
      squares += row * row.transpose();
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 12, 12>> solver(squares);
  const auto& least = solver.eigenvalues();
  // Of points in a plane several cameras are as good.
  if (least(1) < 100.0 * least(0) || least(1) < 1e-9 * least(11)) return std::nullopt;
  const Row p = solver.eigenvectors().col(0);
  Eigen::Matrix<double, 3, 4> camera;
  camera << p.segment<4>(0).transpose(), p.segment<4>(4).transpose(), p.segment<4>(8).transpose();

  double errors = 0.0;
  for (std::size_t k = 0; k < samples.size(); ++k)
    errors += ((camera * places[k]).hnormalized() - samples[k].pixel).squaredNorm();
  if (!(std::sqrt(errors / static_cast<double>(samples.size())) * width < kWorstPixels)) return std::nullopt;
  const Eigen::FullPivLU<Eigen::Matrix3d> rays(camera.leftCols<3>());
  if (!rays.isInvertible()) return std::nullopt;  // parallel rays
  return middle - spread * rays.solve(Vec3(camera.col(3)));
}

}  // namespace

std::optional<Vec3> viewpoint_of_grid(std::span<const cloud::Point> points, std::uint32_t width) {
  return viewpoint_of(sample_grid(points, width), width);
}

}  // namespace tubebin::modeling
