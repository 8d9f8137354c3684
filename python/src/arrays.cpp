// Arrays to what the modules take, and back.
#include <cstring>
#include <initializer_list>
#include <memory>
#include <utility>

#include "bindings.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin::python {
namespace {

using RowMajor4d = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
using RowMajor3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

template <typename Value>
std::vector<std::uint32_t> checked_ids(const IdArray& array, const char* name) {
  const auto* values = static_cast<const Value*>(array.data());
  std::vector<std::uint32_t> ids(array.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (!std::in_range<std::uint32_t>(values[i]))
      throw_config_error("{}: one is {}; valid: whole numbers from 0 (no tube) to {}", name, values[i], UINT32_MAX);
    ids[i] = static_cast<std::uint32_t>(static_cast<std::int64_t>(values[i]));
  }
  return ids;
}

Array<double> owning_array(std::unique_ptr<double[]> values, std::initializer_list<std::size_t> shape) {
  double* data = values.release();
  return {data, shape, nb::capsule(data, [](void* memory) noexcept { delete[] static_cast<double*>(memory); })};
}

}  // namespace

cloud::Cloud cloud_of_points(const PointArray& points) {
  const std::size_t dimensions = points.ndim();
  if ((dimensions != 2 && dimensions != 3) || points.shape(dimensions - 1) != 3)
    throw_config_error("points: have {} dimensions, the last of {} values; valid: (H, W, 3) or (N, 3)", dimensions,
                       dimensions > 0 ? points.shape(dimensions - 1) : 0);
  cloud::Cloud cloud;
  cloud.height = dimensions == 3 ? static_cast<std::uint32_t>(points.shape(0)) : 1;
  cloud.width = static_cast<std::uint32_t>(points.shape(dimensions - 2));
  cloud.points.resize(points.size() / 3);
  if (points.size() > 0) std::memcpy(static_cast<void*>(cloud.points.data()), points.data(), points.nbytes());
  return cloud;
}

std::vector<std::uint32_t> ids_of(const IdArray& array, const char* name) {
  const nb::dlpack::dtype type = array.dtype();
  if (type == nb::dtype<std::uint8_t>()) return checked_ids<std::uint8_t>(array, name);
  if (type == nb::dtype<std::uint16_t>()) return checked_ids<std::uint16_t>(array, name);
  if (type == nb::dtype<std::uint32_t>()) return checked_ids<std::uint32_t>(array, name);
  if (type == nb::dtype<std::uint64_t>()) return checked_ids<std::uint64_t>(array, name);
  if (type == nb::dtype<std::int8_t>()) return checked_ids<std::int8_t>(array, name);
  if (type == nb::dtype<std::int16_t>()) return checked_ids<std::int16_t>(array, name);
  if (type == nb::dtype<std::int32_t>()) return checked_ids<std::int32_t>(array, name);
  if (type == nb::dtype<std::int64_t>()) return checked_ids<std::int64_t>(array, name);
  throw_config_error("{}: are no whole numbers; valid: whole numbers from 0 (no tube) to {}", name, UINT32_MAX);
}

Pose pose_of(const PoseArray& viewpoint) {
  Pose pose = Pose::Identity();
  if (viewpoint.ndim() == 1 && viewpoint.size() == 3) {
    pose.translation() = Eigen::Map<const Vec3>(viewpoint.data());
  } else if (viewpoint.ndim() == 2 && viewpoint.shape(0) == 4 && viewpoint.shape(1) == 4) {
    pose.matrix() = Eigen::Map<const RowMajor4d>(viewpoint.data());
  } else {
    throw_config_error("viewpoint: has {} values; valid: a position (3) or a pose (4, 4)", viewpoint.size());
  }
  const Eigen::Matrix3d turned = pose.linear() * pose.linear().transpose();
  if (!pose.matrix().allFinite() || !turned.isIdentity(1e-6) || pose.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1))
    throw_config_error("viewpoint: is no position or rigid pose; valid: finite numbers, of a pose a rotation");
  return pose;
}

Array<double> array_of(const std::vector<Vec3>& nodes) {
  auto values = std::make_unique<double[]>(3 * nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) Eigen::Map<Vec3>(values.get() + 3 * i) = nodes[i];
  return owning_array(std::move(values), {nodes.size(), 3});
}

Array<double> array_of(const Pose& pose) {
  auto values = std::make_unique<double[]>(16);
  Eigen::Map<RowMajor4d>(values.get()) = pose.matrix();
  return owning_array(std::move(values), {4, 4});
}

Array<double> array_of(const Eigen::Matrix3d& matrix) {
  auto values = std::make_unique<double[]>(9);
  Eigen::Map<RowMajor3d>(values.get()) = matrix;
  return owning_array(std::move(values), {3, 3});
}

}  // namespace tubebin::python
