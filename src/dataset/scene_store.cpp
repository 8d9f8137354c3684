#include "tubebin/dataset/scene_store.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "tubebin/core/file_record.hpp"
#include "tubebin/jobs/atomic_folder.hpp"
#include "tubebin/scene/dataset_files.hpp"
#include "tubebin/scene/tubes_txt.hpp"

namespace tubebin::dataset {
namespace {

namespace fs = std::filesystem;

bool same_point(const cloud::Point& a, const cloud::Point& b) {
  for (int i = 0; i < 3; ++i)
    if (a[i] != b[i] && !(std::isnan(a[i]) && std::isnan(b[i]))) return false;
  return true;
}

/// Compressors have written files before that nothing could read.
void check_reads_back(const std::string& bytes, const cloud::Cloud& cloud, const std::string& path) {
  const cloud::Cloud read = cloud::parse_cloud(bytes, path);
  if (read.points.empty() && cloud.points.empty()) return;  // files have no unique form of no points
  if (read.width != cloud.width || read.height != cloud.height || read.colors != cloud.colors ||
      read.labels != cloud.labels || read.sources != cloud.sources ||
      !std::equal(read.points.begin(), read.points.end(), cloud.points.begin(), cloud.points.end(), same_point))
    throw_io_error("{}: does not read back as it was written", path);
}

void write_readable(const cloud::Cloud& cloud, cloud::CloudFormat format, const std::string& path,
                    const ByteSink& sink) {
  if (format != cloud::CloudFormat::pcd_compressed) return cloud::format_cloud(cloud, format, sink);
  const std::string bytes = cloud::format_cloud(cloud, format);
  check_reads_back(bytes, cloud, path);
  sink(bytes);
}

FileRecord write_recorded(const jobs::FileWriter& write, const ByteSink& sink) {
  FileRecorder recorder;
  write([&](std::string_view block) {
    recorder.add(block);
    sink(block);
  });
  return recorder.record();
}

}  // namespace

std::string SceneStore::cloud_name() const { return std::string("cloud") + extension(options_.format); }

std::string SceneStore::clean_cloud_name() const { return std::string("cloud_clean") + extension(options_.format); }

std::function<std::map<ConfinedPath, FileRecord>()> SceneStore::begin_write(const ConfinedPath& scene_name,
                                                                            SceneContent content) const {
  std::map<std::string, cloud::Cloud> clouds;
  clouds[cloud_name()] = scene::in_space(std::move(content.cloud), content.record.space);
  if (content.clean_cloud)
    clouds[clean_cloud_name()] = scene::in_space(std::move(*content.clean_cloud), content.record.space);

  std::map<ConfinedPath, FileRecord> records;
  std::map<std::string, jobs::FileWriter> files;
  const auto add = [&](const std::string& name, auto write) {
    files[name] = [&records, name, write = std::move(write)](const ByteSink& sink) {
      records[name] = write_recorded(write, sink);
    };
  };
  const auto add_bytes = [&](const std::string& name, std::string bytes) {
    add(name, [bytes = std::move(bytes)](const ByteSink& sink) { sink(bytes); });
  };
  for (const auto& [name, cloud] : clouds)
    add(name, [this, &content_of = cloud, place = path(scene_name) + "/" + name](const ByteSink& sink) {
      write_readable(content_of, options_.format, place, sink);
    });
  for (auto& [name, bytes] : content.images) add_bytes(name, std::move(bytes));
  add_bytes("scene.json", scene::format_scene_json(content.record));
  add_bytes("tubes.txt", scene::format_tubes_txt(content.record.scene.tubes));

  const std::function<void()> finish = jobs::begin_whole_folder(folder_, scene_name, files);
  return [finish, records] {
    finish();
    return records;
  };
}

bool SceneStore::has(const ManifestRecord& record) const {
  if (record.pack) {
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(scene::packs_folder(folder_.path()) + "/" + record.pack->str(), error);
    return !error && bytes >= record.pack_end;
  }
  return std::all_of(record.files.begin(), record.files.end(), [&](const auto& entry) {
    std::error_code error;
    return fs::file_size(path(record.id / entry.first), error) == entry.second.bytes && !error;
  });
}

void SceneStore::remove(const ConfinedPath& scene_name) const {
  if (const FolderEntry entry = folder_.find_entry(scene_name); entry.folder.get() >= 0) remove_entry(entry);
}

void SceneStore::remove_empty_sets(const std::vector<SceneId>& scenes) const {
  std::set<ConfinedPath> sets;
  for (const SceneId& id : scenes)
    for (ConfinedPath set = ConfinedPath(id.name()).parent(); !set.is_folder_itself(); set = set.parent())
      sets.insert(set);
  for (auto set = sets.rbegin(); set != sets.rend(); ++set) {  // inner folders first
    const FolderEntry entry = folder_.find_entry(*set);
    ::unlinkat(entry.folder.get(), entry.name.c_str(), AT_REMOVEDIR);  // does nothing where something is in it
  }
}

void SceneStore::remove_unfinished(const std::vector<SceneId>& scenes, Unfinished which) const {
  std::map<ConfinedPath, std::set<std::string>> names;
  for (const SceneId& id : scenes) {
    const ConfinedPath scene = id.name();
    names[scene.parent()].insert(scene.name());
  }
  for (const auto& [parent, own] : names)
    jobs::remove_unfinished(folder_, parent, which == Unfinished::only ? own : std::set<std::string>{});
  if (which == Unfinished::only) return;
  for (const ConfinedPath& beside : {ConfinedPath(), ConfinedPath("packs"), ConfinedPath(kShardsFolder)})
    jobs::remove_unfinished(folder_, beside);
}

}  // namespace tubebin::dataset
