/// Clouds to and from PCD and PLY files. Nothing that a file states is trusted before it is checked against the
/// file's size.
#pragma once

#include <string>

#include "tubebin/cloud/cloud.hpp"

namespace tubebin {

enum class CloudFormat { pcd_binary, pcd_compressed, pcd_ascii, ply_binary };

/// ".pcd" or ".ply".
const char* extension(CloudFormat format);

/// Writes fields x y z (float32, metres), then rgb (packed float) and label (uint32) where the cloud has them.
/// The file is complete and synced under a temporary name before it takes its own. Throws IoError.
void write_cloud(const std::string& path, const Cloud& cloud, CloudFormat format);

/// Reads a .pcd or .ply file; `scale` multiplies the coordinates (0.001 for files in millimetres).
/// Throws IoError, naming the file and the cause, on anything that is no complete cloud with x y z.
Cloud read_cloud(const std::string& path, double scale = 1.0);

}  // namespace tubebin
