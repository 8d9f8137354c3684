#include "tubebin/dataset/dataset_folder.hpp"

#include <algorithm>
#include <filesystem>

#include "tubebin/core/atomic_file.hpp"

namespace tubebin::dataset {
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

void refuse_if_made_otherwise(const std::string& folder, const DatasetConfig& there, const DatasetConfig& here) {
  const std::vector<std::string> differing = differences(there, here);
  if (differing.empty()) return;
  throw_config_error(
      "{}: was made by another configuration, seed or version; choose another folder or make these "
      "equal:\n  {}",
      folder, fmt::join(differing, "\n  "));
}

bool is_foreign(const fs::path& file) {
  const std::string name = file.filename().string();
  return !name.starts_with('.') && !name.starts_with("config.yaml.");
}

/// A folder with other things in it was hardly meant.
void refuse_if_foreign(const std::string& folder) {
  if (std::none_of(fs::directory_iterator(folder), {}, [](const auto& entry) { return is_foreign(entry.path()); }))
    return;
  if (fs::exists(config_path(folder))) return;  // another part of the same call was quicker
  throw_config_error("{}: holds files, but no data set (config.yaml is missing); choose a new or empty folder", folder);
}

/// Writes config.yaml where it is missing or gains scenes, and returns what it says.
DatasetConfig settle_config(const std::string& folder, const DatasetConfig& wanted) {
  if (!fs::exists(config_path(folder))) {
    refuse_if_foreign(folder);
    if (create_file_atomically(config_path(folder), format_config(wanted))) return wanted;
  }
  const DatasetConfig there = read_dataset_config(folder);
  refuse_if_made_otherwise(folder, there, wanted);
  DatasetConfig settled = unite(there, wanted);
  if (format_config(settled) != format_config(there))
    write_file_atomically(config_path(folder), format_config(settled));
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
  remove_unfinished();
  if (!manifest_.damaged_lines().empty()) manifest_.rewrite_without({});  // their scenes are made anew
}

DatasetFolder::DatasetFolder(const std::string& folder, const DatasetConfig& config, const jobs::Shard& shard,
                             Part part)
    : folder_(make_folder(folder)),
      part_(list_scenes(config, shard)),
      lock_(folder_, jobs::FolderLock::Kind::part),
      config_(settle_config(folder_, config)),
      store_(folder_, config_.output),
      pack_lock_(part == Part::packed ? std::make_unique<jobs::FolderLock>(make_folder(parts_folder(folder_)), shard)
                                      : nullptr),
      manifest_(folder_, shard, *part_) {
  remove_unfinished();
}

void DatasetFolder::remove_unfinished() const {
  if (part_) store_.remove_unfinished(*part_, SceneStore::Unfinished::only);
  else store_.remove_unfinished(list_scenes(config_), SceneStore::Unfinished::all);
}

DatasetFolder::~DatasetFolder() try {
  // Of a part, the next run does it: another host may have been given this one's work.
  if (!part_) remove_unfinished();
} catch (const IoError&) {  // the next run tries again
}

bool DatasetFolder::is_complete(const std::string& scene_name) const {
  const ManifestRecord* record = manifest_.find(scene_name);
  return record != nullptr && store_.has(*record);
}

}  // namespace tubebin::dataset
