/// A whole data set in a format that other programs read (docs/export_formats.md).
#pragma once

#include <string>
#include <vector>

#include "tubebin/jobs/progress.hpp"

namespace tubebin::exports {

/// "bop", "coco", "ply", "npz", "sdf".
std::vector<std::string> export_format_names();

struct ExportOptions {
  std::string dataset;
  std::string output;
  std::string format;
  bool crop = false;     ///< images of the bin's window alone (bop, coco)
  bool normals = false;  ///< with the surfaces' normals (npz)
  int jobs = 1;
  double time_limit = 600.0;  ///< seconds a scene
};

struct ExportReport {
  std::size_t scenes = 0;
  std::size_t complete_before = 0;
  std::size_t made = 0;
  std::vector<std::string> failed;  ///< a line each
  int signal = 0;                   ///< that ended it early, 0 if none did
  double seconds = 0.0;
};

/// Exports the scenes that `output` does not have yet; each appears there whole. A data set that has grown goes on with
/// the numbers that follow. Throws IoError, and ConfigError where the format is unknown or lacks what was chosen, or `output` holds something
/// else: another data set, another format, another version's work, or files that are no export.
ExportReport export_dataset(const ExportOptions& options, jobs::Progress::Style progress);

}  // namespace tubebin::exports
