#include "tubebin/cloud/cloud_io.hpp"

#include <cmath>
#include <new>
#include <stdexcept>

#include "cloud/cloud_formats.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/text_scan.hpp"

namespace tubebin::cloud {
namespace {

void check_consistent(const Cloud& cloud) {
  const std::size_t count = cloud.size();
  if (std::size_t{cloud.width} * cloud.height != count || (!cloud.colors.empty() && cloud.colors.size() != count) ||
      (!cloud.labels.empty() && cloud.labels.size() != count))
    throw std::invalid_argument(fmt::format("cloud of {} x {} with {} points, {} colours, {} labels", cloud.width,
                                            cloud.height, count, cloud.colors.size(), cloud.labels.size()));
}

}  // namespace

const char* extension(CloudFormat format) { return format == CloudFormat::ply_binary ? ".ply" : ".pcd"; }

void format_cloud(const Cloud& cloud, CloudFormat format, const ByteSink& sink) {
  check_consistent(cloud);
  if (format == CloudFormat::ply_binary) sink(format_ply(cloud));
  else format_pcd(cloud, format, sink);
}

std::string format_cloud(const Cloud& cloud, CloudFormat format) {
  constexpr std::size_t kLargestPoint = 24;  // of a binary file
  std::string bytes;
  bytes.reserve(cloud.size() * kLargestPoint);
  format_cloud(cloud, format, [&bytes](std::string_view block) { bytes += block; });
  return bytes;
}

void write_cloud(const std::string& path, const Cloud& cloud, CloudFormat format) {
  write_file_atomically(path, format_cloud(cloud, format));
}

Cloud parse_cloud(std::string_view bytes, const std::string& name, double scale) {
  if (!std::isfinite(scale) || scale <= 0.0)
    throw_config_error("{}: the scale {} is not valid; valid: a number above 0", name, scale);
  if (bytes.empty()) throw_io_error("{}: the file is empty; expected a PCD or PLY cloud", name);
  try {
    if (looks_like_ply(bytes)) return parse_ply(bytes, name, scale);
    if (looks_like_pcd(bytes)) return parse_pcd(bytes, name, scale);
  } catch (const std::bad_alloc&) {
    throw_io_error("{}: its points take more memory than there is", name);
  }
  throw_io_error("{}: neither a PCD nor a PLY file: it starts with '{}'", name, excerpt(bytes));
}

Cloud read_cloud(const std::string& path, double scale) { return parse_cloud(read_file(path), path, scale); }

}  // namespace tubebin::cloud
