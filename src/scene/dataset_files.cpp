#include "tubebin/scene/dataset_files.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>

#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/path_status.hpp"

namespace tubebin::scene {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 2> kClouds = {"cloud.pcd", "cloud.ply"};

}  // namespace

std::string packed_name(const ConfinedPath& scene, const ConfinedPath& file) { return scene.str() + "." + file.str(); }

std::string packs_folder(const std::string& dataset) { return dataset + "/packs"; }

DatasetFiles::DatasetFiles(const std::string& dataset) : dataset_(dataset), is_folder_(is_folder(dataset)) {
  if (!is_folder_) {
    if (is_regular_file(dataset)) add_pack(dataset);
    return;
  }
  for (const std::string& name : names_in_folder(packs_folder(dataset)))
    if (name.ends_with(".tar") && !name.starts_with('.')) add_pack(packs_folder(dataset) + "/" + name);
}

void DatasetFiles::add_pack(const std::string& path) {
  packs_.push_back(path);
  for (TarMember& member : list_tar(path)) {
    if (member.name.starts_with("./")) member.name.erase(0, 2);
    const std::size_t slash = member.name.rfind('/') + 1;  // npos + 1 is 0
    // As programs of macOS add; and what is hidden is no scene's.
    if (member.name[slash] == '.' && member.name.substr(slash) != "..") continue;
    ConfinedPath::parse(member.name, path);
    const std::size_t dot = member.name.find('.', slash);
    if (dot == std::string::npos) continue;
    const std::string scene = member.name.substr(0, dot);
    member.name.erase(0, dot + 1);
    packed_[scene].push_back({packs_.size() - 1, std::move(member)});
  }
}

/// The last one of that name, as tar programs take it.
const DatasetFiles::Packed* DatasetFiles::find_packed(const ConfinedPath& scene, const ConfinedPath& file) const {
  const auto found = packed_.find(scene);
  if (found == packed_.end()) return nullptr;
  const auto match = std::find_if(found->second.rbegin(), found->second.rend(),
                                  [&](const Packed& packed) { return packed.member.name == file.str(); });
  return match == found->second.rend() ? nullptr : &*match;
}

std::string DatasetFiles::loose_path(const ConfinedPath& scene, const ConfinedPath& file) const {
  return fmt::format("{}/{}", dataset_, scene / file);
}

bool DatasetFiles::is_loose(const ConfinedPath& scene, const ConfinedPath& file) const {
  // A file that can't be looked at counts as there: who reads it is told why not.
  std::error_code error;
  return is_folder_ && fs::status(loose_path(scene, file), error).type() != fs::file_type::not_found;
}

bool DatasetFiles::has(const ConfinedPath& scene, const ConfinedPath& file) const {
  return is_loose(scene, file) || find_packed(scene, file) != nullptr;
}

std::string DatasetFiles::read(const ConfinedPath& scene, const ConfinedPath& file) const {
  const Packed* packed = find_packed(scene, file);
  if (packed == nullptr || is_loose(scene, file)) return read_file(loose_path(scene, file));
  return read_tar_member(packs_[packed->pack], packed->member);
}

std::string DatasetFiles::place(const ConfinedPath& scene, const ConfinedPath& file) const {
  const std::string holding = holding_file(scene, file);
  return holding == loose_path(scene, file) ? holding : holding + ":" + packed_name(scene, file);
}

std::string DatasetFiles::holding_file(const ConfinedPath& scene, const ConfinedPath& file) const {
  const Packed* packed = find_packed(scene, file);
  return packed == nullptr || is_loose(scene, file) ? loose_path(scene, file) : packs_[packed->pack];
}

std::string DatasetFiles::cloud_of(const ConfinedPath& scene) const {
  const auto found = std::ranges::find_if(kClouds, [&](const char* file) { return has(scene, file); });
  return found == kClouds.end() ? "" : *found;
}

std::vector<std::string> DatasetFiles::scenes() const {
  std::set<std::string> scenes;
  for (const auto& packed : packed_)
    if (std::ranges::any_of(kClouds, [&](const char* file) { return find_packed(packed.first, file) != nullptr; }))
      scenes.insert(packed.first);
  if (!is_folder_) return {scenes.begin(), scenes.end()};
  std::error_code error;
  fs::path path = dataset_;
  for (fs::recursive_directory_iterator entry(path, error), end; entry != end; entry.increment(error)) {
    path = entry->path();
    if (path.filename().string().starts_with('.')) entry.disable_recursion_pending();
    if (path.filename() != kClouds[0] && path.filename() != kClouds[1]) continue;
    scenes.insert(ConfinedPath::parse(path.parent_path().lexically_relative(dataset_).generic_string(), dataset_));
  }
  if (error) throw_io_error("{}: cannot be searched for clouds: {}", path.string(), error.message());
  return {scenes.begin(), scenes.end()};
}

}  // namespace tubebin::scene
