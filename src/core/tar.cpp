#include "tubebin/core/tar.hpp"

#include <archive.h>
#include <archive_entry.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin {
namespace {

constexpr std::size_t kBlock = 512;  // bytes; a tar consists of such

using TarReader = std::unique_ptr<archive, decltype(&archive_read_free)>;
using Writer = std::unique_ptr<archive, decltype(&archive_write_free)>;
using Entry = std::unique_ptr<archive_entry, decltype(&archive_entry_free)>;

/// A regular file, so that no pipe and no device is waited for.
FileDescriptor open_regular(const std::string& path, std::uint64_t& file_bytes) {
  FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status;
  if (file.get() < 0 || ::fstat(file.get(), &status) != 0)
    throw_io_error("{}: cannot be read: {}", path, std::strerror(errno));
  if (!S_ISREG(status.st_mode)) throw_io_error("{}: cannot be read: is no regular file", path);
  file_bytes = static_cast<std::uint64_t>(status.st_size);
  return file;
}

TarReader open_tar(const FileDescriptor& file, const std::string& path) {
  TarReader reader(archive_read_new(), archive_read_free);
  archive_read_support_format_tar(reader.get());
  archive_read_support_format_empty(reader.get());
  if (archive_read_open_fd(reader.get(), file.get(), kBlock) != ARCHIVE_OK)
    throw_io_error("{}: cannot be read: {}", path, archive_error_string(reader.get()));
  return reader;
}

la_ssize_t collect(archive*, void* text, const void* bytes, std::size_t size) {
  static_cast<std::string*>(text)->append(static_cast<const char*>(bytes), size);
  return static_cast<la_ssize_t>(size);
}

}  // namespace

std::vector<TarMember> list_tar(const std::string& path) {
  std::uint64_t file_bytes = 0;
  const FileDescriptor file = open_regular(path, file_bytes);
  const TarReader reader = open_tar(file, path);
  std::vector<TarMember> members;
  archive_entry* entry = nullptr;
  while (true) {
    const int status = archive_read_next_header(reader.get(), &entry);
    if (status == ARCHIVE_EOF) return members;
    if (status == ARCHIVE_FATAL && !members.empty()) return members;  // cut short within the last member or its header
    if (status != ARCHIVE_OK && status != ARCHIVE_WARN)
      throw_io_error("{}: is no tar file: {}", path, archive_error_string(reader.get()));
    if (archive_entry_filetype(entry) != AE_IFREG) continue;
    const char* name = archive_entry_pathname(entry);  // null where libarchive can't tell it in this locale
    if (name == nullptr) throw_io_error("{}: the name of member {} can't be read", path, members.size() + 1);
    const TarMember member{name, static_cast<std::uint64_t>(archive_filter_bytes(reader.get(), 0)),
                           static_cast<std::uint64_t>(archive_entry_size(entry))};
    if (member.offset > file_bytes || member.bytes > file_bytes - member.offset) return members;
    members.push_back(member);
  }
}

std::string read_tar_member(const std::string& path, const TarMember& member) {
  std::uint64_t file_bytes = 0;
  const FileDescriptor file = open_regular(path, file_bytes);
  std::string bytes = read_bytes(file, member.offset, member.bytes, path);
  if (bytes.size() < member.bytes)
    throw_io_error("{}: {}: ends after {} of {} bytes", path, member.name, bytes.size(), member.bytes);
  return bytes;
}

std::string format_tar_member(const std::string& name, std::string_view bytes) {
  std::string text;
  const Writer writer(archive_write_new(), archive_write_free);
  const Entry entry(archive_entry_new(), archive_entry_free);
  const auto require = [&](bool done) {
    if (!done) throw_io_error("{}: cannot be packed: {}", name, archive_error_string(writer.get()));
  };
  require(archive_write_set_format_ustar(writer.get()) == ARCHIVE_OK);
  require(archive_write_set_bytes_per_block(writer.get(), 0) == ARCHIVE_OK);
  require(archive_write_open(writer.get(), &text, nullptr, collect, nullptr) == ARCHIVE_OK);
  archive_entry_set_pathname(entry.get(), name.c_str());
  archive_entry_set_size(entry.get(), static_cast<la_int64_t>(bytes.size()));
  archive_entry_set_filetype(entry.get(), AE_IFREG);
  archive_entry_set_perm(entry.get(), 0644);
  archive_entry_set_mtime(entry.get(), 0, 0);
  require(archive_write_header(writer.get(), entry.get()) == ARCHIVE_OK);
  require(archive_write_data(writer.get(), bytes.data(), bytes.size()) == static_cast<la_ssize_t>(bytes.size()));
  require(archive_write_finish_entry(writer.get()) == ARCHIVE_OK);
  const std::size_t member_bytes = (text.size() + kBlock - 1) / kBlock * kBlock;  // without what closing adds
  require(archive_write_close(writer.get()) == ARCHIVE_OK);
  text.resize(member_bytes, '\0');
  return text;
}

std::string format_tar_end() { return std::string(2 * kBlock, '\0'); }

}  // namespace tubebin
