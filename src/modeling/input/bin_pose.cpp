#include "modeling/input/bin_pose.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "modeling/input/point_sample.hpp"

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

/// A place that was seen and the face it should lie on, in the bin's frame.
struct Constraint {
  Vec3 place;
  const Plane* face;
};

/// The small motion that brings the places onto their faces: least squares, one Gauss-Newton step. Where no wall is seen,
/// nothing moves the bin along.
Pose small_motion(const std::vector<Constraint>& constraints) {
  Eigen::Matrix<double, 6, 6> normal_matrix = Eigen::Matrix<double, 6, 6>::Identity() * 1e-9;
  Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
  for (const auto& [place, face] : constraints) {
    Eigen::Matrix<double, 6, 1> row;
    row << place.cross(face->normal), face->normal;
    normal_matrix += row * row.transpose();
    right -= row * face->height(place);
  }
  const Eigen::Matrix<double, 6, 1> motion = normal_matrix.ldlt().solve(right);
  const double angle = motion.head<3>().norm();
  Pose pose = Pose::Identity();
  if (angle > 0.0) pose.linear() = Eigen::AngleAxisd(angle, motion.head<3>() / angle).toRotationMatrix();
  pose.translation() = motion.tail<3>();
  return pose;
}

/// Corners of those regions that may be the face.
std::vector<Constraint> corners_on(const Plane& face, const scene::Bin& bin, const Pose& bin_from_world,
                                   const std::vector<FlatRegion>& regions) {
  std::vector<Constraint> corners;
  for (const FlatRegion& region : regions) {
    const Vec3 normal = bin_from_world.linear() * region.plane.normal, center = bin_from_world * region.center;
    if (normal.dot(face.normal) < kParallelWall || std::abs(face.height(center)) > kFarthestOff) continue;
    if (!is_before_face(bin, center)) continue;
    for (const double a : {-1.0, 1.0})
      for (const double b : {-1.0, 1.0})
        corners.push_back({bin_from_world * Vec3(region.center + a * region.half_extents[0] * region.axes[0] +
                                                 b * region.half_extents[1] * region.axes[1]),
                           &face});
  }
  return corners;
}

/// The middle of the points that lie closest about one plane beside the face, where these are most of what is beside it: walls
/// that are seen at a flat angle, or between tubes, are no flat regions.
std::optional<Constraint> layer_beside(const Plane& face, const scene::Bin& bin, const std::vector<Vec3>& points) {
  constexpr double kThickness = 0.002;  // metres
  constexpr std::size_t kFew = 50;
  std::vector<std::pair<double, Vec3>> beside;
  for (const Vec3& p : points)
    if (const double height = face.height(p); std::abs(height) < kFarthestOff / 2.0 && is_before_face(bin, p))
      beside.emplace_back(height, p);
  std::ranges::sort(beside, {}, &std::pair<double, Vec3>::first);
  std::span<const std::pair<double, Vec3>> most;
  for (std::size_t first = 0, end = 0; first < beside.size(); ++first) {
    while (end < beside.size() && beside[end].first < beside[first].first + kThickness) ++end;
    if (end - first > most.size()) most = std::span(beside).subspan(first, end - first);
  }
  if (most.size() < kFew || 2 * most.size() < beside.size()) return std::nullopt;
  Vec3 sum = Vec3::Zero();
  for (const auto& [height, p] : most) sum += p;
  return Constraint{sum / static_cast<double>(most.size()), &face};
}

}  // namespace

bool bin_is_in_place(const ModelingInput& input, double tolerance) {
  constexpr std::size_t kSample = 5000;
  const Pose bin_from_world = input.world_from_bin.inverse();
  const auto faces = inner_planes(*input.bin);
  std::array<int, 5> on = {}, behind = {}, near = {};
  for (const Vec3& in_world : sample_of(input.points, kSample)) {
    const Vec3 p = bin_from_world * in_world;
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
  constexpr std::size_t kSample = 50000;
  const auto faces = inner_planes(*input.bin);
  Pose world_from_bin = input.world_from_bin;
  for (int step = 0; step < kSteps; ++step) {
    const Pose bin_from_world = world_from_bin.inverse();
    std::vector<Constraint> constraints;
    std::vector<const Plane*> others;
    for (const Plane& face : faces) {
      const std::vector<Constraint> corners = corners_on(face, *input.bin, bin_from_world, regions);
      constraints.insert(constraints.end(), corners.begin(), corners.end());
      if (corners.empty()) others.push_back(&face);
    }
    if (constraints.empty()) return std::nullopt;
    // Regions turn the bin first: a plane that leans is no thin layer.
    if (step > 0 && !others.empty()) {
      std::vector<Vec3> points = sample_of(input.points, kSample);
      for (Vec3& p : points) p = bin_from_world * p;
      for (const Plane* face : others)
        if (const auto layer = layer_beside(*face, *input.bin, points)) constraints.push_back(*layer);
    }
    world_from_bin = world_from_bin * small_motion(constraints).inverse();
  }
  return world_from_bin;
}

}  // namespace tubebin::modeling
