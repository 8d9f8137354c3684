#include "dataset/scene_packer.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "tubebin/core/atomic_file.hpp"
#include "tubebin/scene/dataset_files.hpp"

namespace tubebin::dataset {
namespace {

// Waiting for the disk once for so many scenes costs little, and so many folders stand at most beside the tar.
constexpr std::size_t kScenesPerSync = 32;

}  // namespace

ScenePacker::ScenePacker(DatasetFolder& folder, const std::vector<SceneId>& scenes, const std::string& name)
    : folder_(folder),
      scenes_(scenes),
      name_(name + ".tar"),
      path_(scene::packs_folder(folder.store().folder().path()) + "/" + name_.str()),
      states_(scenes.size(), State::awaited) {
  for (const auto& [id, record] : folder.manifest().records())
    if (record.pack == name_) end_ = std::max(end_, record.pack_end);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const std::string id = scenes[i].name();
    if (!folder.is_complete(id)) continue;
    const bool is_packed = folder.manifest().find(id)->pack.has_value();
    states_[i] = is_packed ? State::done : State::loose;
    if (is_packed) folder.store().remove(id);  // a kill came between packing and removing
  }
  pack_those_in_turn();
}

void ScenePacker::add(std::size_t position) {
  states_[position] = State::loose;
  pack_those_in_turn();
}

void ScenePacker::give_up(std::size_t position) {
  states_[position] = State::done;
  pack_those_in_turn();
}

void ScenePacker::finish(bool is_last) {
  flush();
  folder_.store().remove_empty_sets(scenes_);
  if (!is_last || (end_ == 0 && file_.get() < 0)) return;
  write("");  // opens the tar that was complete already
  const std::string end = format_tar_end();
  if (pwrite(file_.get(), end.data(), end.size(), static_cast<off_t>(end_)) != static_cast<ssize_t>(end.size()) ||
      fsync(file_.get()) != 0)
    throw_io_error("{}: cannot be written: {}", path_, std::strerror(errno));
}

void ScenePacker::pack_those_in_turn() {
  for (; next_ < scenes_.size() && states_[next_] != State::awaited; ++next_)
    if (states_[next_] == State::loose) append(scenes_[next_]);
}

void ScenePacker::append(const SceneId& id) {
  ManifestRecord record = *folder_.manifest().find(id.name());
  for (const auto& [file, expected] : record.files)
    write(format_tar_member(scene::packed_name(record.id, file), read_file(folder_.store().path(record.id / file))));
  record.pack = name_;
  record.pack_end = end_;
  unrecorded_.push_back(std::move(record));
  if (unrecorded_.size() >= kScenesPerSync) flush();
}

void ScenePacker::flush() {
  if (unrecorded_.empty()) return;
  if (fsync(file_.get()) != 0) throw_io_error("{}: cannot be written: {}", path_, std::strerror(errno));
  for (const ManifestRecord& record : unrecorded_) {
    folder_.manifest().append(record);
    folder_.store().remove(record.id);
  }
  unrecorded_.clear();
}

void ScenePacker::write(std::string_view bytes) {
  const auto fail = [&] { throw_io_error("{}: cannot be written: {}", path_, std::strerror(errno)); };
  if (file_.get() < 0) {
    file_ = open_file(folder_.store().folder().make_entry(ConfinedPath("packs") / name_), O_WRONLY | O_CREAT);
    if (ftruncate(file_.get(), static_cast<off_t>(end_)) != 0) fail();
  }
  while (!bytes.empty()) {
    const ssize_t written = pwrite(file_.get(), bytes.data(), bytes.size(), static_cast<off_t>(end_));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail();
    bytes.remove_prefix(static_cast<std::size_t>(written));
    end_ += static_cast<std::uint64_t>(written);
  }
}

}  // namespace tubebin::dataset
