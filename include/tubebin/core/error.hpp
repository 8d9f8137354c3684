/// The errors that reach a user. Each message names the file, the place, the value, and what would be right.
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>

namespace tubebin {

/// What the programs exit with.
enum class ExitCode : int { done = 0, failed = 1, usage = 2, incomplete = 3 };

/// Input that can't be read or output that can't be written: exit code 1.
class IoError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An option or a configuration that can't be meant: exit code 2.
class ConfigError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

template <typename... Args>
[[noreturn]] void throw_io_error(fmt::format_string<Args...> format, Args&&... args) {
  throw IoError(fmt::format(format, std::forward<Args>(args)...));
}

template <typename... Args>
[[noreturn]] void throw_config_error(fmt::format_string<Args...> format, Args&&... args) {
  throw ConfigError(fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace tubebin
