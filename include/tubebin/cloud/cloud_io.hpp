/// Clouds to and from PCD and PLY files. Nothing that a file states is trusted before it is checked against
/// the file's size.
#pragma once

#include <string>
#include <string_view>

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/core/file_record.hpp"

namespace tubebin::cloud {

enum class CloudFormat { pcd_binary, pcd_compressed, pcd_ascii, ply_binary };

/// ".pcd" or ".ply".
const char* extension(CloudFormat format);

/// Writes fields x y z (float32, metres), then rgb (packed float; red green blue in PLY), label and source
/// (uint32) where the cloud has them. PLY keeps rows, columns and sensor pose in a `camera` element, as PCL does. The
/// file is complete and synced under a temporary name before it takes its own. Throws IoError.
void write_cloud(const std::string& path, const Cloud& cloud, CloudFormat format);

/// The bytes of such a file.
std::string format_cloud(const Cloud& cloud, CloudFormat format);

/// The same, handed on in blocks; those of a binary PCD file are small enough for the processor's cache.
void format_cloud(const Cloud& cloud, CloudFormat format, const ByteSink& sink);

/// Reads a PCD or PLY file, told apart by their first bytes: coordinates of any type, organized or not,
/// colours as rgb, rgba or red green blue, labels and sources as whole numbers of any type; other fields, faces and the
/// like are skipped. `scale` multiplies the coordinates (0.001 for files in millimetres). Throws IoError,
/// naming the file and the cause, on anything that is no complete cloud with x y z.
Cloud read_cloud(const std::string& path, double scale = 1.0);

/// As read_cloud, from the bytes of a file; `name` stands for the file in messages.
Cloud parse_cloud(std::string_view bytes, const std::string& name, double scale = 1.0);

}  // namespace tubebin::cloud
