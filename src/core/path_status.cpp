#include "tubebin/core/path_status.hpp"

#include <algorithm>
#include <filesystem>

#include "tubebin/core/error.hpp"

namespace tubebin {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, const char* problem, const std::error_code& error) {
  throw_io_error("{}: {}: {}{}", path, problem, error.message(),
                 error == std::errc::filename_too_long ? "; valid: names of up to 255 bytes, paths of up to 4095" : "");
}

fs::file_type type_of(const std::string& path) {
  std::error_code error;
  const fs::file_type type = fs::status(path, error).type();
  if (type == fs::file_type::none) fail(path, "cannot be looked at", error);
  return type;
}

}  // namespace

bool path_exists(const std::string& path) { return type_of(path) != fs::file_type::not_found; }

bool is_folder(const std::string& path) { return type_of(path) == fs::file_type::directory; }

bool is_regular_file(const std::string& path) { return type_of(path) == fs::file_type::regular; }

std::vector<std::string> names_in_folder(const std::string& path) {
  std::vector<std::string> names;
  if (!is_folder(path)) return names;
  std::error_code error;
  for (fs::directory_iterator entry(path, error), end; entry != end; entry.increment(error))
    names.push_back(entry->path().filename().string());
  if (error) fail(path, "cannot be listed", error);
  std::ranges::sort(names);
  return names;
}

std::string absolute_path(const std::string& path) {
  std::error_code error;
  std::string absolute = fs::absolute(path, error).string();
  if (error) fail(path, "its place cannot be told", error);
  return absolute;
}

std::string relative_path(const std::string& path, const std::string& base) {
  std::error_code error;
  std::string relative = fs::relative(absolute_path(path), absolute_path(base), error).string();
  if (error) fail(path, "its place cannot be told", error);
  return relative;
}

}  // namespace tubebin
