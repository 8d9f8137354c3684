/// PLY 1.0 (Turk 1994, "The PLY Polygon File Format"), with PCL's `camera` element.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

#include "cloud/cloud_formats.hpp"

namespace tubebin::cloud {
namespace {

static_assert(std::endian::native == std::endian::little);

/// The names and their order are PCL's: its reader takes sensor pose, rows and columns from them.
constexpr const char* kCameraProperties =
    "element camera 1\nproperty float view_px\nproperty float view_py\nproperty float view_pz\n"
    "property float x_axisx\nproperty float x_axisy\nproperty float x_axisz\n"
    "property float y_axisx\nproperty float y_axisy\nproperty float y_axisz\n"
    "property float z_axisx\nproperty float z_axisy\nproperty float z_axisz\n"
    "property float focal\nproperty float scalex\nproperty float scaley\nproperty float centerx\n"
    "property float centery\nproperty int viewportx\nproperty int viewporty\nproperty float k1\nproperty "
    "float k2\n";

/// `int` where all values fit: some readers drop `uint`.
const char* type_of(const std::vector<std::uint32_t>& values) {
  const bool fit = std::ranges::all_of(values, [](std::uint32_t value) { return std::in_range<std::int32_t>(value); });
  return fit ? "int" : "uint";
}

std::string format_header(const Cloud& cloud) {
  std::string header = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\n",
      cloud.size());
  if (!cloud.colors.empty()) header += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (!cloud.labels.empty()) header += fmt::format("property {} label\n", type_of(cloud.labels));
  if (!cloud.sources.empty()) header += fmt::format("property {} source\n", type_of(cloud.sources));
  return header + kCameraProperties + "end_header\n";
}

template <typename Value>
void append(std::string& out, const Value& value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

void append_camera(std::string& out, const Cloud& cloud) {
  const Eigen::Vector3f position = cloud.world_from_sensor.translation().cast<float>();
  const Eigen::Matrix3f rotation = cloud.world_from_sensor.linear().cast<float>();
  for (int i = 0; i < 3; ++i) append(out, position[i]);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) append(out, rotation(row, column));
  for (int unused = 0; unused < 5; ++unused) append(out, 0.0F);  // focal to centery
  append(out, cloud.width);
  append(out, cloud.height);
  for (int unused = 0; unused < 2; ++unused) append(out, 0.0F);  // k1, k2
}

}  // namespace

std::string format_ply(const Cloud& cloud) {
  constexpr std::size_t kLargestVertex = 23;
  constexpr std::size_t kCamera = 84;
  std::string out = format_header(cloud);
  out.reserve(out.size() + cloud.size() * kLargestVertex + kCamera);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    out.append(reinterpret_cast<const char*>(cloud.points[i].data()), sizeof(Point));
    if (!cloud.colors.empty())
      for (const int shift : {16, 8, 0}) out.push_back(static_cast<char>(cloud.colors[i] >> shift & 0xFF));
    if (!cloud.labels.empty()) append(out, cloud.labels[i]);
    if (!cloud.sources.empty()) append(out, cloud.sources[i]);
  }
  append_camera(out, cloud);
  return out;
}

}  // namespace tubebin::cloud
