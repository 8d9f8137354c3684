#include "tubebin/jobs/atomic_folder.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <set>
#include <vector>

#include "core/file_descriptor.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin::jobs {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUnfinishedSuffix = ".partial";

/// "DIR/A10/.007.host-1234-0.partial": a hidden sibling, so that the rename stays within one folder, and no other
/// process's, should two make the same scene.
fs::path unfinished_path(const fs::path& scene) {
  static std::atomic<unsigned> counter = 0;
  return scene.parent_path() /
         fmt::format(".{}.{}-{}{}", scene.filename().string(), process_name(), counter++, kUnfinishedSuffix);
}

/// Removes `path`, a folder of the scene's or a file, at once for everybody else: it is renamed before it is emptied. So
/// who still writes into it fails, and gives no final name to a folder some of whose files are gone.
void remove_at_once(const fs::path& path, const fs::path& scene) {
  const fs::path removed = unfinished_path(scene);
  std::error_code error;
  fs::rename(path, removed, error);
  if (error == std::errc::no_such_file_or_directory) return;  // another was quicker
  if (!error) fs::remove_all(removed, error);
  // A file that was just being made in it, or that is still open on NFS, is left to who clears next.
  if (error && error != std::errc::directory_not_empty && error != std::errc::no_such_file_or_directory)
    throw fs::filesystem_error("remove", path, error);
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

  /// The file's path; the folders between are made.
  std::string file(const std::string& name) {
    const fs::path file = path_ / name;
    for (fs::path folder = file.parent_path(); folder != path_; folder = folder.parent_path()) inner_.insert(folder);
    if (file.parent_path() != path_) fs::create_directories(file.parent_path());
    return file.string();
  }

  void rename_to_final() const {
    for (const fs::path& folder : inner_) sync_folder(folder);
    sync_folder(path_);
    while (!take_name())
      ;
    sync_folder(scene_.parent_path());
  }

 private:
  /// Returns false where it is to be tried again, since the name was taken or freed meanwhile.
  bool take_name() const {
    std::error_code error;
    fs::rename(path_, scene_, error);
    if (!error) return true;
    if (error != std::errc::directory_not_empty && error != std::errc::file_exists &&
        error != std::errc::not_a_directory)
      throw fs::filesystem_error("rename", path_, scene_, error);
    if (renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, scene_.c_str(), RENAME_EXCHANGE) == 0) {
      remove_at_once(path_, scene_);
      return true;
    }
    // Some file systems (NFS) can't exchange names; there the scene is gone for a moment.
    if (errno != ENOENT) remove_at_once(scene_, scene_);
    return false;
  }

  fs::path scene_;
  fs::path path_;
  std::set<fs::path> inner_;
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

/// Some file systems make no hard links, and none makes them to another disk.
bool asks_for_copy(const std::error_code& error) {
  return error == std::errc::cross_device_link || error == std::errc::operation_not_permitted ||
         error == std::errc::not_supported || error == std::errc::function_not_supported ||
         error == std::errc::too_many_links;
}

/// A hard link to the file, or a copy that is on the disk.
void link_or_copy(const std::string& source, const std::string& path) {
  std::error_code error;
  fs::create_hard_link(source, path, error);
  if (!error) return;
  if (!asks_for_copy(error)) throw fs::filesystem_error("link", source, path, error);
  fs::copy_file(source, path);
  const FileDescriptor copy(open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (copy.get() < 0 || fsync(copy.get()) != 0) throw_io_error("{}: cannot be written: {}", path, std::strerror(errno));
}

/// The files of one folder on their way to the disk.
class FolderOnItsWay {
 public:
  FolderOnItsWay(const std::string& path, const std::map<std::string, std::string>& files) try
      : path_(path), folder_(path) {
    for (const auto& [name, bytes] : files) files_.emplace_back(folder_.file(name), bytes);
  } catch (const fs::filesystem_error& error) {
    throw_io_error("{}: cannot be written: {}", path, error.code().message());
  }

  void arrive() const try {
    for (const NewFile& file : files_) file.sync();
    folder_.rename_to_final();
  } catch (const fs::filesystem_error& error) {
    throw_io_error("{}: cannot be written: {}", path_, error.code().message());
  }

 private:
  std::string path_;
  UnfinishedFolder folder_;
  std::vector<NewFile> files_;
};

}  // namespace

std::function<void()> begin_whole_folder(const std::string& path, const std::map<std::string, std::string>& files) {
  return [folder = std::make_shared<FolderOnItsWay>(path, files)] { folder->arrive(); };
}

std::function<void()> begin_linked_folder(const std::string& path,
                                          const std::map<std::string, std::string>& sources) try {
  const auto folder = std::make_shared<UnfinishedFolder>(path);
  for (const auto& [name, source] : sources) link_or_copy(source, folder->file(name));
  return [folder, path] {
    try {
      folder->rename_to_final();
    } catch (const fs::filesystem_error& error) {
      throw_io_error("{}: cannot be written: {}", path, error.code().message());
    }
  };
} catch (const fs::filesystem_error& error) {
  throw_io_error("{}: cannot be written: {}", path, error.code().message());
}

void link_file(const std::string& source, const std::string& path) try {
  const std::string unfinished = unfinished_path(path).string();
  fs::remove(unfinished);
  link_or_copy(source, unfinished);
  fs::rename(unfinished, path);
  // Renaming a link over another one of the same file does nothing and leaves it.
  fs::remove(unfinished);
  sync_folder(fs::path(path).parent_path());
} catch (const fs::filesystem_error& error) {
  throw_io_error("{}: cannot be written: {}", path, error.code().message());
}

bool is_unfinished_folder(const std::string& path) {
  const std::string name = fs::path(path).filename().string();
  return name.starts_with('.') && name.ends_with(kUnfinishedSuffix);
}

void remove_unfinished_folders(const std::string& folder, const std::set<std::string>& of) try {
  // Listed first, since removing takes new names.
  std::vector<fs::path> unfinished;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (is_unfinished_folder(entry.path().string())) unfinished.push_back(entry.path());
  for (const fs::path& path : unfinished) {
    const std::string name = path.filename().string();
    const std::string scene = name.substr(1, name.find('.', 1) - 1);
    if (of.empty() || of.contains(scene)) remove_at_once(path, path.parent_path() / scene);
  }
} catch (const fs::filesystem_error& error) {
  throw_io_error("{}: cannot be cleared of what is unfinished: {}", folder, error.code().message());
}

}  // namespace tubebin::jobs
