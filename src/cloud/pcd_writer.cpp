/// PCD 0.7 (https://pointclouds.org/documentation/tutorials/pcd_file_format.html).
#include <fmt/format.h>
#include <lzf.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <limits>

#include "cloud/cloud_formats.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin::cloud {
namespace {

static_assert(sizeof(Point) == 3 * sizeof(float) && sizeof(Color) == 4 && sizeof(Label) == 4);
constexpr std::size_t kScalarSize = 4;  // of every field that is written here

std::string format_header(const Cloud& cloud, CloudFormat format) {
  std::string fields = "x y z", sizes = "4 4 4", types = "F F F", counts = "1 1 1";
  const auto add = [&](const char* field, const char* type) {
    fields += field, types += type, sizes += " 4", counts += " 1";
  };
  // Text keeps a colour as a whole number (as PCL writes it); as a float its digits would be in danger.
  if (!cloud.colors.empty()) add(" rgb", format == CloudFormat::pcd_ascii ? " U" : " F");
  if (!cloud.labels.empty()) add(" label", " U");
  if (!cloud.sources.empty()) add(" source", " U");
  const Vec3 t = cloud.world_from_sensor.translation();
  const Quat q(cloud.world_from_sensor.linear());
  const char* data = format == CloudFormat::pcd_ascii        ? "ascii"
                     : format == CloudFormat::pcd_compressed ? "binary_compressed"
                                                             : "binary";
  return fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS {}\nSIZE {}\nTYPE {}\nCOUNT {}\nWIDTH "
      "{}\n"
      "HEIGHT {}\nVIEWPOINT {} {} {} {} {} {} {}\nPOINTS {}\nDATA {}\n",
      fields, sizes, types, counts, cloud.width, cloud.height, t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z(),
      cloud.size(), data);
}

std::size_t point_size(const Cloud& cloud) {
  return kScalarSize *
         (3 + (cloud.colors.empty() ? 0 : 1) + (cloud.labels.empty() ? 0 : 1) + (cloud.sources.empty() ? 0 : 1));
}

/// Point by point. A block is put together, and taken, in the processor's cache.
void write_binary(const Cloud& cloud, const ByteSink& sink) {
  constexpr std::size_t kBlock = 4096;
  const std::size_t stride = point_size(cloud);
  std::array<char, kBlock * 6 * kScalarSize> block;
  for (std::size_t begin = 0; begin < cloud.size(); begin += kBlock) {
    const std::size_t count = std::min(kBlock, cloud.size() - begin);
    char* field = block.data();
    const auto put = [&](const auto& values) {
      if (values.empty()) return;
      constexpr std::size_t kSize = sizeof(values[0]);
      const char* from = reinterpret_cast<const char*>(values.data() + begin);
      for (std::size_t i = 0; i < count; ++i) std::memcpy(field + i * stride, from + i * kSize, kSize);
      field += kSize;
    };
    put(cloud.points);
    put(cloud.colors);
    put(cloud.labels);
    put(cloud.sources);
    sink({block.data(), count * stride});
  }
}

/// Field by field, which compresses better.
std::string fields_one_by_one(const Cloud& cloud) {
  std::string out(cloud.size() * point_size(cloud), '\0');
  char* at = out.data();
  const auto put = [&at](const void* value) {
    std::memcpy(at, value, kScalarSize);
    at += kScalarSize;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const Point& point : cloud.points) put(&point[axis]);
  for (const Color& color : cloud.colors) put(&color);
  for (const Label& label : cloud.labels) put(&label);
  for (const std::uint32_t& source : cloud.sources) put(&source);
  return out;
}

/// LZF of literal runs alone: a little longer than the input, and always readable.
std::string lzf_literals(std::string_view input) {
  constexpr std::size_t kLongestRun = 32;
  std::string out;
  out.reserve(input.size() + input.size() / kLongestRun + 1);
  for (; !input.empty(); input.remove_prefix(std::min(kLongestRun, input.size()))) {
    const std::string_view run = input.substr(0, kLongestRun);
    out.push_back(static_cast<char>(run.size() - 1));
    out += run;
  }
  return out;
}

/// What the compressor makes is read back before it counts: PCL's copy of it has had outputs that its own reader
/// refused.
std::string compress(const std::string& input) {
  const auto size = static_cast<unsigned int>(input.size());
  // Its output is below 104 % of the input (lzf.h).
  std::string out(input.size() + input.size() / 16 + 64, '\0');
  out.resize(lzf_compress(input.data(), size, out.data(), static_cast<unsigned int>(out.size())));
  std::string back(input.size(), '\0');
  const auto out_size = static_cast<unsigned int>(out.size());
  const bool readable = !out.empty() && lzf_decompress(out.data(), out_size, back.data(), size) == size;
  return readable && back == input ? out : lzf_literals(input);
}

void write_compressed(const Cloud& cloud, const ByteSink& sink) {
  const std::string fields = fields_one_by_one(cloud);
  if (fields.size() + fields.size() / 16 + 64 > std::numeric_limits<std::uint32_t>::max())
    throw_io_error("a cloud of {} points is too large for a compressed PCD file (4 GB); write it binary", cloud.size());
  const std::string compressed = fields.empty() ? "" : compress(fields);
  for (const std::size_t size : {compressed.size(), fields.size()}) {
    const auto stored = static_cast<std::uint32_t>(size);
    sink({reinterpret_cast<const char*>(&stored), sizeof(stored)});
  }
  sink(compressed);
}

void write_ascii(const Cloud& cloud, const ByteSink& sink) {
  std::string out;
  const auto end = std::back_inserter(out);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Point& p = cloud.points[i];
    fmt::format_to(end, "{} {} {}", p.x(), p.y(), p.z());
    if (!cloud.colors.empty()) fmt::format_to(end, " {}", cloud.colors[i]);
    if (!cloud.labels.empty()) fmt::format_to(end, " {}", cloud.labels[i]);
    if (!cloud.sources.empty()) fmt::format_to(end, " {}", cloud.sources[i]);
    out += '\n';
  }
  sink(out);
}

}  // namespace

void format_pcd(const Cloud& cloud, CloudFormat format, const ByteSink& sink) {
  sink(format_header(cloud, format));
  if (format == CloudFormat::pcd_ascii) write_ascii(cloud, sink);
  else if (format == CloudFormat::pcd_compressed) write_compressed(cloud, sink);
  else write_binary(cloud, sink);
}

}  // namespace tubebin::cloud
