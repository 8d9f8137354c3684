/// What stands at a path that the user names. Where that can't be told, since a folder on the way may not be searched or a
/// name is too long, IoError names path and cause; std::filesystem would throw an error of its own.
#pragma once

#include <string>
#include <vector>

namespace tubebin {

bool path_exists(const std::string& path);
/// Links are followed.
bool is_folder(const std::string& path);
bool is_regular_file(const std::string& path);

/// All names in the folder but "." and "..", in order; none where there is no such folder.
std::vector<std::string> names_in_folder(const std::string& path);

/// The path from the root on, and that of `path` seen from the folder `base`.
std::string absolute_path(const std::string& path);
std::string relative_path(const std::string& path, const std::string& base);

}  // namespace tubebin
