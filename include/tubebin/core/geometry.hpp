/// Points, poses and angle units shared by every module. Metres and radians unless a name says otherwise.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace tubebin {

using Vec3 = Eigen::Vector3d;
using Quat = Eigen::Quaterniond;
/// Rigid transform; named `a_from_b`, it takes coordinates in frame b to coordinates in frame a.
using Pose = Eigen::Isometry3d;

constexpr double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }
constexpr double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

/// From 0 to pi, exact near both.
inline double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

inline Pose make_pose(const Quat& rotation, const Vec3& translation) {
  Pose pose = Pose::Identity();
  pose.linear() = rotation.toRotationMatrix();
  pose.translation() = translation;
  return pose;
}

}  // namespace tubebin
