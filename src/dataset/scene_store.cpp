#include "tubebin/dataset/scene_store.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "file_descriptor.hpp"
#include "tubebin/scene/tubes_txt.hpp"

namespace tubebin {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUnfinishedSuffix = ".partial";

/// "DIR/A10/.007.partial": a hidden sibling, so that the rename stays within one folder.
fs::path unfinished_path(const fs::path& scene) {
  return scene.parent_path() / fmt::format(".{}{}", scene.filename().string(), kUnfinishedSuffix);
}

bool is_unfinished(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.starts_with('.') && name.ends_with(kUnfinishedSuffix);
}

void sync_folder(const fs::path& path) {
  const FileDescriptor folder(open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // Some file systems can't sync folders; there a rename is as safe as they make it.
  if (folder.get() < 0 || (fsync(folder.get()) != 0 && errno != EINVAL && errno != ENOTSUP))
    throw_io_error("{}: cannot be synced: {}", path.string(), std::strerror(errno));
}

/// A new folder that is gone at the end of the scope unless it was renamed.
class UnfinishedFolder {
 public:
  explicit UnfinishedFolder(fs::path scene) : scene_(std::move(scene)), path_(unfinished_path(scene_)) {
    if (fs::create_directories(scene_.parent_path())) sync_folder(scene_.parent_path().parent_path());
    fs::remove_all(path_);
    fs::create_directory(path_);
  }
  ~UnfinishedFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  UnfinishedFolder(const UnfinishedFolder&) = delete;
  UnfinishedFolder& operator=(const UnfinishedFolder&) = delete;

  std::string file(const std::string& name) const { return (path_ / name).string(); }

  void rename_to_final() const {
    sync_folder(path_);
    fs::remove_all(scene_);
    fs::rename(path_, scene_);
    sync_folder(scene_.parent_path());
  }

 private:
  fs::path scene_;
  fs::path path_;
};

/// A new file whose bytes are on their way to the disk, and there after sync().
class NewFile {
 public:
  NewFile(std::string path, std::string_view bytes)
      : path_(std::move(path)), file_(open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
    if (file_.get() < 0) fail();
    while (!bytes.empty()) {
      const ssize_t written = ::write(file_.get(), bytes.data(), bytes.size());
      if (written < 0 && errno != EINTR) fail();
      if (written > 0) bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    sync_file_range(file_.get(), 0, 0, SYNC_FILE_RANGE_WRITE);  // only begins; what fails shows in sync()
  }
  void sync() const {
    if (fsync(file_.get()) != 0) fail();
  }

 private:
  [[noreturn]] void fail() const { throw_io_error("{}: cannot be written: {}", path_, std::strerror(errno)); }

  std::string path_;
  FileDescriptor file_;
};

bool same_point(const Point& a, const Point& b) {
  for (int i = 0; i < 3; ++i)
    if (a[i] != b[i] && !(std::isnan(a[i]) && std::isnan(b[i]))) return false;
  return true;
}

/// Compressed files have been written before that nothing could read.
void check_reads_back(const std::string& bytes, const Cloud& cloud, const std::string& path) {
  const Cloud read = parse_cloud(bytes, path);
  if (read.points.empty() && cloud.points.empty()) return;  // files have no unique form of no points
  if (read.width != cloud.width || read.height != cloud.height || read.colors != cloud.colors ||
      read.labels != cloud.labels ||
      !std::equal(read.points.begin(), read.points.end(), cloud.points.begin(), cloud.points.end(), same_point))
    throw_io_error("{}: does not read back as it was written", path);
}

}  // namespace

std::string SceneStore::cloud_name() const { return std::string("cloud") + extension(options_.format); }

std::map<std::string, FileRecord> SceneStore::write(const std::string& scene_name,
                                                    const SceneContent& content) const try {
  std::map<std::string, std::string> files = content.images;
  files[cloud_name()] = format_cloud(content.cloud, options_.format);
  files["scene.json"] = format_scene_json(content.record);
  files["tubes.txt"] = format_tubes_txt(content.record.scene.tubes);

  const UnfinishedFolder folder(path(scene_name));
  std::vector<NewFile> written;
  std::map<std::string, FileRecord> records;
  for (const auto& [name, bytes] : files) written.emplace_back(folder.file(name), bytes);
  for (const auto& [name, bytes] : files) records[name] = record_bytes(bytes);
  check_reads_back(files[cloud_name()], content.cloud, path(scene_name) + "/" + cloud_name());
  for (const NewFile& file : written) file.sync();
  folder.rename_to_final();
  return records;
} catch (const fs::filesystem_error& error) {
  throw_io_error("{}: cannot be written: {}", path(scene_name), error.code().message());
}

bool SceneStore::has(const ManifestRecord& record) const {
  return std::all_of(record.files.begin(), record.files.end(), [&](const auto& entry) {
    std::error_code error;
    return fs::file_size(fs::path(path(record.id)) / entry.first, error) == entry.second.bytes && !error;
  });
}

void SceneStore::remove_unfinished() const try {
  for (const fs::directory_entry& set : fs::directory_iterator(folder_)) {
    if (!set.is_directory()) continue;
    for (const fs::directory_entry& scene : fs::directory_iterator(set))
      if (is_unfinished(scene.path())) fs::remove_all(scene.path());
  }
} catch (const fs::filesystem_error& error) {
  throw_io_error("{}: cannot be cleared of unfinished scenes: {}", folder_, error.code().message());
}

}  // namespace tubebin
