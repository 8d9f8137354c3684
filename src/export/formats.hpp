/// The formats of export_dataset (docs/export_formats.md).
#pragma once

#include <memory>

#include "export/scene_export.hpp"
#include "export/scene_image.hpp"
#include "tubebin/dataset/dataset_config.hpp"

namespace tubebin::exports {

/// BOP (benchmark for 6D object pose estimation), scenewise: images, masks, poses, a mesh for each object; millimetres.
std::unique_ptr<ExportFormat> bop_format(ImageRegion region);
/// COCO instance segmentation: an image a scene, one annotation file for all.
std::unique_ptr<ExportFormat> coco_format(ImageRegion region);
/// The published data set's folders: clouds of the tubes alone as PLY, tubes as text.
std::unique_ptr<ExportFormat> ply_format();
/// Arrays for numpy, PyTorch and JAX, one file a scene; the normals of the surfaces are optional.
std::unique_ptr<ExportFormat> npz_format(bool with_normals);
/// Gazebo worlds (SDFormat 1.7), as the published data set's, with the settings of each scene's drop.
std::unique_ptr<ExportFormat> sdf_format(const dataset::DatasetConfig& config);

}  // namespace tubebin::exports
