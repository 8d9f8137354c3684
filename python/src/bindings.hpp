/// The parts of the extension module, and what they share. Arrays that leave are views of memory that their owner keeps.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <vector>

#include "tubebin/cloud/cloud.hpp"

namespace tubebin::python {

namespace nb = nanobind;

void bind_cloud(nb::module_& module);
void bind_depth_image(nb::module_& module);
void bind_scene(nb::module_& module);
void bind_dataset(nb::module_& module);
void bind_model(nb::module_& module);
void bind_evaluation(nb::module_& module);

/// Positions as they come in, H x W x 3 or N x 3; nanobind converts other numbers and layouts.
using PointArray = nb::ndarray<const float, nb::c_contig, nb::device::cpu>;
/// Labels or colours as they come in, one a point, whole numbers of any type.
using IdArray = nb::ndarray<nb::ro, nb::c_contig, nb::device::cpu>;
/// A position (3) or a pose (4 x 4).
using PoseArray = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
/// What goes out.
template <typename Value>
using Array = nb::ndarray<nb::numpy, Value>;

/// Width, height and points of a cloud. Throws ConfigError.
cloud::Cloud cloud_of_points(const PointArray& points);
/// World frame from sensor frame; of a position alone the axes are the world's. Throws ConfigError.
Pose pose_of(const PoseArray& viewpoint);
/// The array's values. Throws ConfigError, which calls them `name`, where one is no whole number or does not fit.
std::vector<std::uint32_t> ids_of(const IdArray& array, const char* name);

/// A view of `values`, one a point of an organized cloud or another; `owner` keeps them alive.
template <typename Value>
Array<Value> per_point(std::vector<Value>& values, std::size_t height, std::size_t width, bool organized,
                       nb::handle owner) {
  if (organized) return Array<Value>(values.data(), {height, width}, owner);
  return Array<Value>(values.data(), {values.size()}, owner);
}

/// Polyline as an array N x 3 of its own.
Array<double> array_of(const std::vector<Vec3>& nodes);
/// Pose as an array 4 x 4, matrix as an array 3 x 3 of its own.
Array<double> array_of(const Pose& pose);
Array<double> array_of(const Eigen::Matrix3d& matrix);

}  // namespace tubebin::python
