#include "scan/embree.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace tubebin::embree {
namespace {

/// Embree walks its tree in single precision with rays from the origin: a direction and a bound are each off
/// by at most 2^-24 of the distance, the box test by a few times that. Bounds grow by 32 x 2^-24 of the
/// farthest corner's distance (4 micrometres at 2 m), so that no solid is missed; what is hit is then decided
/// in double precision.
constexpr double kBoundsPadding = 32.0 * 0x1p-24;

}  // namespace

void check_device(const embree::Device& device) {
  const RTCError error = rtcGetDeviceError(device.get());
  if (error != RTC_ERROR_NONE) throw std::runtime_error(fmt::format("Embree failed with error {}", int{error}));
}

const embree::Device& device() {
  static const embree::Device device = [] {
    embree::Device made(rtcNewDevice("threads=1"));
    check_device(made);
    return made;
  }();
  return device;
}

void set_bounds(const Eigen::AlignedBox3d& box, RTCBounds& bounds) {
  const double padding = kBoundsPadding * box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).norm();
  const Eigen::Vector3f low = (box.min().array() - padding).cast<float>();
  const Eigen::Vector3f high = (box.max().array() + padding).cast<float>();
  bounds.lower_x = low.x();
  bounds.lower_y = low.y();
  bounds.lower_z = low.z();
  bounds.upper_x = high.x();
  bounds.upper_y = high.y();
  bounds.upper_z = high.z();
}

}  // namespace tubebin::embree
