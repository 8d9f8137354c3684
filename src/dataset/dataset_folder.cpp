#include "tubebin/dataset/dataset_folder.hpp"

#include <algorithm>

#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/path_status.hpp"
#include "tubebin/core/version.hpp"

namespace tubebin::dataset {
namespace {

constexpr const char* kConfigFile = "config.yaml";

std::string config_path(const std::string& folder) { return folder + "/" + kConfigFile; }

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
  const auto is_foreign = [](const std::string& name) { return !name.starts_with('.'); };
  if (std::ranges::none_of(names_in_folder(folder), is_foreign)) return;
  if (path_exists(config_path(folder))) return;  // another shard of the same call was quicker
  throw_config_error("{}: holds files, but no data set (config.yaml is missing); choose a new or empty folder", folder);
}

void copy_mesh(const OutputFolder& folder, const scene::Bin& bin) {
  if (bin.surface) create_atomically(folder.make_entry(bin.mesh), bin.surface->stl);
}

/// Writes config.yaml where it is missing or gains scenes, and returns what it says.
DatasetConfig create_or_extend_config(const OutputFolder& folder, const DatasetConfig& wanted) {
  const std::string path = config_path(folder.path());
  if (!path_exists(path)) {
    refuse_if_foreign(folder.path());
    copy_mesh(folder, wanted.bin);
    if (create_atomically(folder.make_entry(kConfigFile), format_config(wanted))) return wanted;
  }
  const DatasetConfig there = read_dataset_config(folder.path());
  refuse_if_made_otherwise(folder.path(), there, wanted);
  DatasetConfig extended = unite(there, wanted);
  if (format_config(extended) != format_config(there))
    write_atomically(folder.make_entry(kConfigFile), format_config(extended));
  return extended;
}

}  // namespace

DatasetConfig read_dataset_config(const std::string& folder) {
  if (!path_exists(config_path(folder))) throw_io_error("{}: is no data set: config.yaml is missing", folder);
  DatasetConfig config;
  const KeyPlaces places = read_yaml_file(config_path(folder), fields_of(config));
  load_mesh(config.bin, folder);
  check_of_any_version(config, places);
  return config;
}

void require_own_version(const DatasetConfig& config, const std::string& folder) {
  if (config.tool_version != tool_version())
    throw_config_error("{}: tool_version: '{}' made this data set and '{}' is running, whose scenes may differ",
                       config_path(folder), config.tool_version, tool_version());
}

DatasetFolder::DatasetFolder(const std::string& folder, const DatasetConfig& config)
    : folder_(folder),
      lock_(folder_),
      config_(create_or_extend_config(folder_, config)),
      store_(folder_, config_.output),
      manifest_(folder_) {
  remove_unfinished();
  if (!manifest_.damaged_lines().empty()) manifest_.rewrite_without({});  // their scenes are made anew
}

DatasetFolder::DatasetFolder(const std::string& folder, const DatasetConfig& config, const jobs::Shard& shard,
                             ShardScenes scenes)
    : folder_(folder),
      shard_scenes_(list_scenes(config, shard)),
      lock_(folder_, jobs::FolderLock::Kind::shard),
      config_(create_or_extend_config(folder_, config)),
      store_(folder_, config_.output),
      pack_lock_(scenes == ShardScenes::packed
                     ? std::make_unique<jobs::FolderLock>(folder_.make_inner(kShardsFolder), shard)
                     : nullptr),
      manifest_(folder_, shard, *shard_scenes_) {
  remove_unfinished();
}

void DatasetFolder::remove_unfinished() const {
  if (shard_scenes_) store_.remove_unfinished(*shard_scenes_, SceneStore::Unfinished::only);
  else store_.remove_unfinished(list_scenes(config_), SceneStore::Unfinished::all);
}

DatasetFolder::~DatasetFolder() try {
  // For a shard the next run does it: another host may have been given this one's work.
  if (!shard_scenes_) remove_unfinished();
} catch (const IoError&) {  // the next run tries again
}

void DatasetFolder::restore_config() {
  copy_mesh(folder_, config_.bin);
  create_atomically(folder_.make_entry(kConfigFile), format_config(config_));
}

bool DatasetFolder::is_complete(const std::string& scene_name) const {
  const ManifestRecord* record = manifest_.find(scene_name);
  return record != nullptr && store_.has(*record);
}

}  // namespace tubebin::dataset
