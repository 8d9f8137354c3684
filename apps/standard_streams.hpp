/// Standard streams as programs may rely on them: open, and checked once.
#pragma once

#include <fcntl.h>
#include <stdio_ext.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <string>

namespace tubebin {

/// A stream that was closed would give its number to the next file that is opened, and that would get the messages. And
/// messages that nobody can take (a full disk, a pipe whose reader is gone) must not end the work that they are about.
inline void open_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    // Of stdout, for reading: what is written there fails, and close_standard_output() says so.
    if (fcntl(stream, F_GETFD) < 0) open("/dev/null", stream == STDERR_FILENO ? O_WRONLY : O_RDONLY);
  static const auto write_if_possible = [](void*, const char* text, std::size_t size) -> ssize_t {
    for (std::size_t written = 0; written < size;) {
      const ssize_t count = ::write(STDERR_FILENO, text + written, size - written);
      if (count < 0 && errno != EINTR) break;
      if (count > 0) written += static_cast<std::size_t>(count);
    }
    return static_cast<ssize_t>(size);
  };
  FILE* forgiving =
      fopencookie(nullptr, "w", {.read = nullptr, .write = write_if_possible, .seek = nullptr, .close = nullptr});
  if (forgiving != nullptr) {
    setvbuf(forgiving, nullptr, _IONBF, 0);
    stderr = forgiving;
  }
  // A file that is longer than `ulimit -f` allows is an error like a full disk, with a message.
  std::signal(SIGXFSZ, SIG_IGN);
}

/// Whether all results have reached standard output: empty, or what went wrong.
inline std::string close_standard_output() {
  std::cout.flush();
  errno = 0;
  const bool failed = std::ferror(stdout) != 0 || !std::cout;
  if (std::fflush(stdout) == 0 && !failed) return "";
  return std::string("standard output: cannot be written") +
         (errno != 0 ? std::string(": ") + std::strerror(errno) : "");
}

}  // namespace tubebin
