#include "tubebin/dataset/dataset_folder.hpp"

#include <algorithm>
#include <filesystem>

#include "tubebin/core/atomic_file.hpp"

namespace tubebin {
namespace {

namespace fs = std::filesystem;

std::string config_path(const std::string& folder) { return folder + "/config.yaml"; }

std::string make_folder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder))
    throw_io_error("{}: cannot be made: {}", folder, error ? error.message() : "a file of that name is there");
  return folder;
}

/// Numbers of tubes and cases of both, so that config.yaml covers every scene that was ever asked for.
DatasetConfig unite(const DatasetConfig& there, DatasetConfig here) {
  std::vector<int> tubes = there.tubes;
  for (const int count : here.tubes)
    if (std::find(tubes.begin(), tubes.end(), count) == tubes.end()) tubes.push_back(count);
  here.tubes = tubes;
  here.cases = std::max(there.cases, here.cases);
  return here;
}

void refuse_if_made_otherwise(const std::string& folder, const DatasetConfig& there, const DatasetConfig& here) {
  const std::vector<std::string> differing = differences(there, here);
  if (differing.empty()) return;
  throw_config_error(
      "{}: was made by another configuration, seed or version; choose another folder or make these "
      "equal:\n  {}",
      folder, fmt::join(differing, "\n  "));
}

/// A folder with other things in it was hardly meant.
void refuse_if_foreign(const std::string& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (!entry.path().filename().string().starts_with('.') &&
        !entry.path().filename().string().starts_with("config.yaml."))
      throw_config_error("{}: holds files, but no data set (config.yaml is missing); choose a new or empty folder",
                         folder);
}

/// Writes config.yaml where it is missing or gains scenes, and returns what it says.
DatasetConfig settle_config(const std::string& folder, const DatasetConfig& wanted) {
  DatasetConfig settled = wanted;
  std::string text_there;
  if (fs::exists(config_path(folder))) {
    const DatasetConfig there = read_dataset_config(folder);
    refuse_if_made_otherwise(folder, there, wanted);
    settled = unite(there, wanted);
    text_there = format_config(there);
  } else {
    refuse_if_foreign(folder);
  }
  if (format_config(settled) != text_there) write_file_atomically(config_path(folder), format_config(settled));
  return settled;
}

}  // namespace

DatasetConfig read_dataset_config(const std::string& folder) {
  if (!fs::exists(config_path(folder))) throw_io_error("{}: is no data set: config.yaml is missing", folder);
  DatasetConfig config;
  read_yaml_file(config_path(folder), fields_of(config));
  return config;
}

DatasetFolder::DatasetFolder(const std::string& folder, const DatasetConfig& config)
    : folder_(make_folder(folder)),
      lock_(folder_),
      config_(settle_config(folder_, config)),
      store_(folder_, config_.output),
      manifest_(folder_) {
  store_.remove_unfinished();
  if (!manifest_.damaged_lines().empty()) manifest_.rewrite_without({});  // their scenes are made anew
}

DatasetFolder::~DatasetFolder() try {
  store_.remove_unfinished();
} catch (const IoError&) {  // the next run tries again
}

bool DatasetFolder::is_complete(const std::string& scene_name) const {
  const ManifestRecord* record = manifest_.find(scene_name);
  return record != nullptr && store_.has(*record);
}

}  // namespace tubebin
