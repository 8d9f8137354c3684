#include <fmt/ranges.h>

#include <algorithm>
#include <type_traits>

#include "export/formats.hpp"
#include "export/object_numbers.hpp"
#include "export/surface_normal.hpp"
#include "export/zip.hpp"

namespace tubebin::exports {
namespace {

template <typename Value>
constexpr const char* kNumpyType = nullptr;
template <>
constexpr const char* kNumpyType<float> = "<f4";
template <>
constexpr const char* kNumpyType<double> = "<f8";
template <>
constexpr const char* kNumpyType<std::int32_t> = "<i4";
template <>
constexpr const char* kNumpyType<std::int64_t> = "<i8";
template <>
constexpr const char* kNumpyType<std::uint8_t> = "|u1";

/// A .npy file, version 1.0: magic, the header's length, a Python dictionary padded to 64 bytes, the values.
std::string npy(const std::string& type, std::string_view values, const std::vector<std::size_t>& shape) {
  std::string header =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({},), }}", type, fmt::join(shape, ", "));
  constexpr std::size_t kPrefix = 10, kAlignment = 64;
  header.append(kAlignment - 1 - (kPrefix + header.size()) % kAlignment, ' ');
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() & 0xFF);
  bytes += static_cast<char>(header.size() >> 8);
  bytes += header;
  return bytes.append(values);
}

template <typename Value>
std::string npy(const std::vector<Value>& values, const std::vector<std::size_t>& shape) {
  return npy(kNumpyType<Value>, {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value)}, shape);
}

/// Texts of one length, padded with NULs.
std::string npy(const std::vector<std::string>& texts) {
  std::size_t length = 1;
  for (const std::string& text : texts) length = std::max(length, text.size());
  std::string bytes;
  for (std::string text : texts) {
    text.resize(length);
    bytes += text;
  }
  return npy(fmt::format("|S{}", length), bytes, {texts.size()});
}

template <typename Matrix>
void append_rows(std::vector<double>& values, const Matrix& matrix) {
  for (int row = 0; row < matrix.rows(); ++row)
    for (int column = 0; column < matrix.cols(); ++column) values.push_back(matrix(row, column));
}

std::vector<std::size_t> image_shape(const cloud::Cloud& cloud) {
  return cloud.organized() ? std::vector<std::size_t>{cloud.height, cloud.width}
                           : std::vector<std::size_t>{cloud.size()};
}

std::vector<std::size_t> operator+(std::vector<std::size_t> shape, std::size_t size) {
  shape.push_back(size);
  return shape;
}

void add_cloud(const cloud::Cloud& cloud, Files& arrays) {
  std::vector<float> points;
  std::vector<std::int32_t> labels;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    points.insert(points.end(), cloud.points[i].data(), cloud.points[i].data() + 3);
    labels.push_back(cloud::is_finite(cloud.points[i]) ? static_cast<std::int32_t>(cloud.labels[i]) : -1);
  }
  arrays["points.npy"] = npy(points, image_shape(cloud) + 3);
  arrays["labels.npy"] = npy(labels, image_shape(cloud));
  if (!cloud.sources.empty())
    arrays["sources.npy"] = npy(std::vector<std::int32_t>(cloud.sources.begin(), cloud.sources.end()), {cloud.size()});
}

/// Of the exact surfaces, world frame; NaN where nothing was scanned.
void add_normals(const SceneToExport& scene, Files& arrays) {
  const SurfaceNormals surfaces(scene.record.scene);
  std::vector<float> normals;
  for (std::size_t i = 0; i < scene.cloud.size(); ++i) {
    const cloud::Point& point = scene.cloud.points[i];
    Eigen::Vector3f normal = point;
    if (cloud::is_finite(point)) normal = surfaces.at(scene.cloud.labels[i], point.cast<double>()).cast<float>();
    normals.insert(normals.end(), normal.data(), normal.data() + 3);
  }
  arrays["normals.npy"] = npy(normals, image_shape(scene.cloud) + 3);
}

void add_scanner(const scene::SceneRecord& record, Files& arrays) {
  const scene::Camera camera(record.scene.scanner);
  std::vector<double> intrinsics, pose;
  append_rows(intrinsics, camera.intrinsics());
  append_rows(pose, camera.world_from_scanner().matrix());
  const scene::PixelWindow& window = record.window;
  arrays["intrinsics.npy"] = npy(intrinsics, {3, 3});
  arrays["world_from_scanner.npy"] = npy(pose, {4, 4});
  arrays["window.npy"] = npy(std::vector<std::int64_t>{window.x, window.y, window.width, window.height}, {4});
  arrays["image_size.npy"] = npy(std::vector<std::int64_t>{camera.width(), camera.height()}, {2});
}

/// Tubes have different numbers of nodes: all nodes stand in one array, and another says whose they are.
void add_tubes(const SceneToExport& scene, Files& arrays) {
  std::vector<double> poses, radii, nodes, cylinder_radii;
  std::vector<std::string> kinds;
  std::vector<std::int64_t> tube_of_node, cylinders, visible, amodal;
  std::int64_t first_node = 0;
  const scan::PileView view = scan::view_pile(scene.record.scene);
  for (std::size_t k = 0; k < view.amodal_pixels.size(); ++k) {
    const scene::PlacedTube& placed = scene.record.scene.tubes[k];
    append_rows(poses, placed.world_from_tube.matrix());
    radii.push_back(placed.tube.radius);
    kinds.push_back(identify(placed.tube).kind);
    for (int node = 0; node < static_cast<int>(placed.tube.nodes.size()); ++node) {
      append_rows(nodes, placed.node_in_world(node));
      tube_of_node.push_back(static_cast<std::int64_t>(k + 1));
    }
    for (const tube::Cylinder& cylinder : placed.tube.cylinders) {
      cylinders.insert(cylinders.end(), {first_node + cylinder.node_a, first_node + cylinder.node_b});
      cylinder_radii.push_back(placed.tube.radius_of(cylinder));
    }
    first_node += static_cast<std::int64_t>(placed.tube.nodes.size());
    visible.push_back(static_cast<std::int64_t>(scene.record.tube_pixels[k]));
    amodal.push_back(static_cast<std::int64_t>(view.amodal_pixels[k]));
  }
  arrays["world_from_tube.npy"] = npy(poses, {radii.size(), 4, 4});
  arrays["kind.npy"] = npy(kinds);
  arrays["radius.npy"] = npy(radii, {radii.size()});
  arrays["nodes.npy"] = npy(nodes, {tube_of_node.size(), 3});
  arrays["tube_of_node.npy"] = npy(tube_of_node, {tube_of_node.size()});
  arrays["cylinders.npy"] = npy(cylinders, {cylinders.size() / 2, 2});
  arrays["cylinder_radius.npy"] = npy(cylinder_radii, {cylinder_radii.size()});
  arrays["visible_pixels.npy"] = npy(visible, {visible.size()});
  arrays["amodal_pixels.npy"] = npy(amodal, {amodal.size()});
}

class NpzFormat : public ExportFormat {
 public:
  explicit NpzFormat(bool with_normals) : with_normals_(with_normals) {}

  std::string scene_path(const SceneEntry& entry) const override { return entry.name + ".npz"; }

  SceneFiles export_scene(const SceneToExport& scene) const override {
    const SceneImage checked(scene, ImageRegion::full);
    Files arrays;
    add_cloud(scene.cloud, arrays);
    if (with_normals_) add_normals(scene, arrays);
    add_scanner(scene.record, arrays);
    add_tubes(scene, arrays);
    return {.beside = {}, .scene = {{"", format_zip(arrays)}}};
  }

 private:
  bool with_normals_;
};

}  // namespace

std::unique_ptr<ExportFormat> npz_format(bool with_normals) { return std::make_unique<NpzFormat>(with_normals); }

}  // namespace tubebin::exports
