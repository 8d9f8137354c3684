#include "modeling/input/bin_pose.hpp"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <numbers>

namespace tubebin::modeling {
namespace {

constexpr double kFarthestOff = 0.03;    ///< metres
constexpr double kParallelWall = 0.985;  ///< the cosine of 10 degrees
constexpr double kBeside = 0.02;         ///< metres that a face may reach beyond where it should end

/// The large inner faces of a bin in its own frame: floor first, then the walls. Normals look inward.
std::array<Plane, 5> inner_planes(const scene::Bin& bin) {
  const std::vector<scene::InnerFace> faces = scene::inner_faces(bin);
  std::array<Plane, 5> planes;
  for (std::size_t i = 0; i < planes.size(); ++i) planes[i] = {-faces[i].outward, -faces[i].offset};
  return planes;
}

/// Whether a point near a face is in front of that face's area, and not beside it.
bool is_before_face(const scene::Bin& bin, const Vec3& p) {
  const double beside = kBeside + std::tan(radians(bin.draft_deg)) * std::max(p.z(), 0.0);
  return std::abs(p.x()) < bin.length / 2.0 + beside && std::abs(p.y()) < bin.width / 2.0 + beside &&
         p.z() > -kBeside && p.z() < bin.height - kBeside;
}

/// A region's corner and the face it should lie on, in the bin's frame.
struct Constraint {
  Vec3 corner;
  const Plane* face;
};

/// The small motion that brings the corners onto their faces: least squares, one Gauss-Newton step. Where no wall is seen,
/// nothing moves the bin along.
Pose small_motion(const std::vector<Constraint>& constraints) {
  Eigen::Matrix<double, 6, 6> normal_matrix = Eigen::Matrix<double, 6, 6>::Identity() * 1e-9;
  Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
  for (const auto& [corner, face] : constraints) {
    Eigen::Matrix<double, 6, 1> row;
    row << corner.cross(face->normal), face->normal;
    normal_matrix += row * row.transpose();
    right -= row * face->height(corner);
  }
  const Eigen::Matrix<double, 6, 1> motion = normal_matrix.ldlt().solve(right);
  const double angle = motion.head<3>().norm();
  Pose pose = Pose::Identity();
  if (angle > 0.0) pose.linear() = Eigen::AngleAxisd(angle, motion.head<3>() / angle).toRotationMatrix();
  pose.translation() = motion.tail<3>();
  return pose;
}

}  // namespace

bool bin_is_in_place(const ModelingInput& input, double tolerance) {
  constexpr std::size_t kSample = 5000;
  const Pose bin_from_world = input.world_from_bin.inverse();
  const auto faces = inner_planes(*input.bin);
  std::array<int, 5> on = {}, behind = {}, near = {};
  for (std::size_t i = 0; i < input.points.size(); i += input.points.size() / kSample + 1) {
    if (!cloud::is_finite(input.points[i])) continue;
    const Vec3 p = bin_from_world * input.points[i].cast<double>();
    if (!is_before_face(*input.bin, p)) continue;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const double height = faces[f].height(p);
      if (std::abs(height) < tolerance) ++on[f];
      else if (height < 0.0 && height > -kBeside) ++behind[f];
      else if (height > 0.0 && height < kFarthestOff / 2.0) ++near[f];
    }
  }
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (10 * behind[f] > on[f] + 20 || 4 * on[f] + 20 < near[f]) return false;
  return true;
}

std::optional<Pose> refined_bin_pose(const ModelingInput& input, const std::vector<FlatRegion>& regions) {
  constexpr int kSteps = 3;
  const auto faces = inner_planes(*input.bin);
  Pose world_from_bin = input.world_from_bin;
  for (int step = 0; step < kSteps; ++step) {
    const Pose bin_from_world = world_from_bin.inverse();
    std::vector<Constraint> constraints;
    for (const FlatRegion& region : regions) {
      const Vec3 normal = bin_from_world.linear() * region.plane.normal, center = bin_from_world * region.center;
      for (const Plane& face : faces) {
        if (normal.dot(face.normal) < kParallelWall || std::abs(face.height(center)) > kFarthestOff) continue;
        if (!is_before_face(*input.bin, center)) continue;
        for (const double a : {-1.0, 1.0})
          for (const double b : {-1.0, 1.0})
            constraints.push_back({bin_from_world * Vec3(region.center + a * region.half_extents[0] * region.axes[0] +
                                                         b * region.half_extents[1] * region.axes[1]),
                                   &face});
      }
    }
    if (constraints.empty()) return std::nullopt;
    world_from_bin = world_from_bin * small_motion(constraints).inverse();
  }
  return world_from_bin;
}

}  // namespace tubebin::modeling
