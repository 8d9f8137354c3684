/// The file formats behind cloud_io.
#pragma once

#include <string>
#include <string_view>

#include "tubebin/cloud/cloud_io.hpp"

namespace tubebin::cloud {

bool looks_like_pcd(std::string_view bytes);
bool looks_like_ply(std::string_view bytes);

Cloud parse_pcd(std::string_view bytes, const std::string& name, double scale);
Cloud parse_ply(std::string_view bytes, const std::string& name, double scale);

void format_pcd(const Cloud& cloud, CloudFormat format, const ByteSink& sink);
std::string format_ply(const Cloud& cloud);

}  // namespace tubebin::cloud
