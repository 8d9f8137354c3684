/// Tar files (POSIX ustar, through libarchive): members appended one by one, found again, and read where they lie.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tubebin {

/// Where the bytes of a member lie in its file.
struct TarMember {
  std::string name;
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
};

/// The regular files in an uncompressed tar, in order. A last member that is cut short is left out: a file that is still
/// growing can be read. Throws IoError where it is no tar.
std::vector<TarMember> list_tar(const std::string& path);

/// The bytes of a member. Throws IoError.
std::string read_tar_member(const std::string& path, const TarMember& member);

/// A member as it stands in a tar: header, bytes, padding. Equal arguments give equal bytes (no time, no owner).
std::string format_tar_member(const std::string& name, std::string_view bytes);

/// What ends a tar.
std::string format_tar_end();

}  // namespace tubebin
