// Clouds: read, written, and made of arrays.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <map>

#include "bindings.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin::python {
namespace {

using cloud::Cloud;

static_assert(sizeof(cloud::Point) == 3 * sizeof(float), "points are views of N x 3 floats");

const std::map<std::string, cloud::CloudFormat> kFormats = {{"pcd_binary", cloud::CloudFormat::pcd_binary},
                                                            {"pcd_compressed", cloud::CloudFormat::pcd_compressed},
                                                            {"pcd_ascii", cloud::CloudFormat::pcd_ascii},
                                                            {"ply_binary", cloud::CloudFormat::ply_binary}};

/// The format that is asked for, else the one that the file's name tells.
cloud::CloudFormat choose_format(const std::string& path, const std::string& format) {
  if (const auto found = kFormats.find(format); found != kFormats.end()) return found->second;
  if (!format.empty())
    throw_config_error("format: '{}' is not valid; valid: pcd_binary, pcd_compressed, pcd_ascii, ply_binary", format);
  if (path.ends_with(".pcd")) return cloud::CloudFormat::pcd_binary;
  if (path.ends_with(".ply")) return cloud::CloudFormat::ply_binary;
  throw_config_error("{}: is neither .pcd nor .ply, so its format must be told", path);
}

/// One a point, or none.
std::vector<std::uint32_t> ids_of_points(const std::optional<IdArray>& ids, const Cloud& cloud, const char* name) {
  if (!ids) return {};
  const bool fits = ids->ndim() == 1 || (ids->ndim() == 2 && ids->shape(1) == cloud.width);
  if (!fits || ids->size() != cloud.size())
    throw_config_error("{}: {} values; valid: one of each of the {} points, in their shape", name, ids->size(),
                       cloud.size());
  return ids_of(*ids, name);
}

Cloud make_cloud(const PointArray& points, const std::optional<IdArray>& labels, const std::optional<IdArray>& colors,
                 const std::optional<PoseArray>& viewpoint) {
  Cloud cloud = cloud_of_points(points);
  cloud.labels = ids_of_points(labels, cloud, "labels");
  cloud.colors = ids_of_points(colors, cloud, "colors");
  if (viewpoint) cloud.world_from_sensor = pose_of(*viewpoint);
  return cloud;
}

/// A view of one number a point, or None where the cloud has none.
template <std::vector<std::uint32_t> Cloud::*member>
std::optional<Array<std::uint32_t>> view_of(nb::handle self) {
  Cloud& cloud = nb::cast<Cloud&>(self);
  if ((cloud.*member).empty()) return std::nullopt;
  return per_point(cloud.*member, cloud.height, cloud.width, cloud.organized(), self);
}

Array<float> points_of(nb::handle self) {
  Cloud& cloud = nb::cast<Cloud&>(self);
  auto* values = reinterpret_cast<float*>(cloud.points.data());
  if (cloud.organized()) return Array<float>(values, {cloud.height, cloud.width, 3}, self);
  return Array<float>(values, {cloud.size(), 3}, self);
}

}  // namespace

void bind_cloud(nb::module_& module) {
  nb::class_<Cloud>(module, "Cloud",
                    "A point cloud: (H, W) where it is organized as an image, (N,) where not. All arrays are views of "
                    "its memory: what is written into them is written into the cloud.")
      .def(
          "__init__",
          [](Cloud* self, const PointArray& points, const std::optional<IdArray>& labels,
             const std::optional<IdArray>& colors, const std::optional<PoseArray>& viewpoint) {
            new (self) Cloud(make_cloud(points, labels, colors, viewpoint));
          },
          nb::arg("points"), nb::arg("labels") = nb::none(), nb::arg("colors") = nb::none(),
          nb::arg("viewpoint") = nb::none(),
          nb::sig("def __init__(self, points: NDArray[numpy.floating], labels: NDArray[numpy.integer] | None = None, "
                  "colors: NDArray[numpy.integer] | None = None, viewpoint: NDArray[numpy.floating] | None = None) -> "
                  "None"),
          "Copies the arrays: points (H, W, 3) or (N, 3), metres; labels and colors one a point; viewpoint the "
          "sensor's position (3,) or pose (4, 4).")
      .def_prop_ro("points", &points_of,
                   "(H, W, 3) or (N, 3) float32, metres, world frame; NaN where a pixel hit nothing.")
      .def_prop_ro("labels", &view_of<&Cloud::labels>,
                   "(H, W) or (N,) uint32, k of tube k, 0 of the bin and of pixels that hit nothing; None without.")
      .def_prop_ro("colors", &view_of<&Cloud::colors>,
                   "(H, W) or (N,) uint32, 0x00RRGGBB, 0 where a point has no tube; None without.")
      .def_prop_ro("sources", &view_of<&Cloud::sources>,
                   "(N,) uint32, which of several scanners saw the point, from 0; None of one scanner.")
      .def_prop_ro(
          "viewpoint", [](const Cloud& self) { return array_of(self.world_from_sensor); }, nb::rv_policy::automatic,
          "(4, 4) float64, world frame from sensor frame (x right, y down, z along the view): where the sensor stood, "
          "metres; of several that of source 0. A copy.")
      .def_prop_ro("organized", &Cloud::organized, "Whether the points are the pixels of an image, row by row.")
      .def("__len__", &Cloud::size, "Number of points, with those that hit nothing.");

  module.def("read_cloud", &cloud::read_cloud, nb::arg("path"), nb::arg("scale"),
             nb::call_guard<nb::gil_scoped_release>());
  module.def(
      "write_cloud",
      [](const std::string& path, const Cloud& cloud, const std::string& format) {
        cloud::write_cloud(path, cloud, choose_format(path, format));
      },
      nb::arg("path"), nb::arg("cloud"), nb::arg("format"), nb::call_guard<nb::gil_scoped_release>());
}

}  // namespace tubebin::python
