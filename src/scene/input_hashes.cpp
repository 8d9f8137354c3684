#include "tubebin/scene/input_hashes.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <tuple>

#include "core/json_reader.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/file_record.hpp"
#include "tubebin/core/path_status.hpp"
#include "tubebin/core/text_scan.hpp"

namespace tubebin::scene {
namespace {

bool is_before(const std::timespec& a, const std::timespec& b) {
  return std::tie(a.tv_sec, a.tv_nsec) < std::tie(b.tv_sec, b.tv_nsec);
}

/// Of one file of a manifest's line.
std::string recorded_hash(const JsonPlace& files, const char* name) {
  return files.has(name) ? files.at(name).at("xxh128").text() : "";
}

std::string shown(const std::string& hash) { return hash.empty() ? "none" : hash; }

}  // namespace

DatasetHashes::DatasetHashes(const DatasetFiles& files) : files_(files) {
  read_manifest(files.dataset() + "/manifest.jsonl");
  const std::string parts = files.dataset() + "/manifest.parts";
  for (const std::string& name : names_in_folder(parts))
    if (name.ends_with(".jsonl")) read_manifest(parts + "/" + name);
}

void DatasetHashes::read_manifest(const std::string& path) {
  struct stat status;
  if (!path_exists(path) || stat(path.c_str(), &status) != 0) return;
  if (is_before(manifest_written_, status.st_mtim)) manifest_written_ = status.st_mtim;
  const std::string text = read_file(path);
  LineScanner lines(text);
  for (auto line = lines.next_filled(); line; line = lines.next_filled()) try {
      const auto json = parse_json(*line, path);
      const JsonPlace files = JsonPlace(json, path).at("files");
      const std::string pcd = recorded_hash(files, "cloud.pcd");
      recorded_[JsonPlace(json, path).at("id").text()] = {
          .cloud_xxh128 = pcd.empty() ? recorded_hash(files, "cloud.ply") : pcd,
          .scene_json_xxh128 = recorded_hash(files, "scene.json")};
    } catch (const IoError&) {  // a line that is damaged, or just being written, records nothing
    }
}

/// The time of its last change of any kind, which no program can set back.
bool DatasetHashes::is_older_than_manifest(const std::string& path) const {
  struct stat status;
  return stat(path.c_str(), &status) == 0 && !is_before(manifest_written_, status.st_ctim);
}

InputHashes DatasetHashes::of(const ConfinedPath& scene) const {
  InputHashes hashes;
  if (files_.has(scene, "scene.json")) hashes.scene_json_xxh128 = record_bytes(files_.read(scene, "scene.json")).xxh128;
  const std::string cloud = files_.cloud_of(scene);
  if (cloud.empty()) return hashes;
  const auto recorded = recorded_.find(scene);
  const bool is_known = recorded != recorded_.end() && !recorded->second.cloud_xxh128.empty() &&
                        recorded->second.scene_json_xxh128 == hashes.scene_json_xxh128 &&
                        is_older_than_manifest(files_.holding_file(scene, cloud));
  hashes.cloud_xxh128 = is_known ? recorded->second.cloud_xxh128 : record_bytes(files_.read(scene, cloud)).xxh128;
  return hashes;
}

void DatasetHashes::require_recorded(const ConfinedPath& scene, const InputHashes& read) const {
  const auto recorded = recorded_.find(scene);
  if (recorded == recorded_.end()) return;
  const auto require = [&](const std::string& found, const std::string& wanted, const std::string& file) {
    if (!wanted.empty() && !found.empty() && found != wanted)
      throw_io_error(
          "{}: has hash {}, and {} in the data set's manifest: it is another file than was generated; "
          "generate_dataset --verify tells more",
          files_.place(scene, file), found, wanted);
  };
  require(read.scene_json_xxh128, recorded->second.scene_json_xxh128, "scene.json");
  require(read.cloud_xxh128, recorded->second.cloud_xxh128, files_.cloud_of(scene));
}

void require_same(const InputHashes& made_from, const InputHashes& now, const std::string& result,
                  const std::string& scene) {
  const auto require = [&](const std::string& there, const std::string& then, const char* what) {
    if (!there.empty() && there != then)
      throw_io_error(
          "{}: was made from another {} (hash {}) than {} has now (hash {}); the same call of model_tubes makes "
          "it anew",
          result, what, shown(then), scene, there);
  };
  require(now.scene_json_xxh128, made_from.scene_json_xxh128, "scene.json");
  require(now.cloud_xxh128, made_from.cloud_xxh128, "cloud");
}

}  // namespace tubebin::scene
