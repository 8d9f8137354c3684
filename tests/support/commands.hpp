/// Runs Python where a test compares with it; tests skip where it, or a module that it needs, is missing.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>

namespace tubebin::testing {

/// A Python 3 that has the modules ("numpy, scipy"), if there is one.
inline std::optional<std::string> find_python(const std::string& modules) {
  for (const std::string python : {"python3", "/usr/bin/python3"})
    if (std::system((python + " -c 'import " + modules + "' >/dev/null 2>&1").c_str()) == 0) return python;
  return std::nullopt;
}

struct CommandResult {
  int exit_code = -1;
  std::string output;  ///< stdout, and stderr where the command redirects it
};

inline CommandResult run_command(const std::string& command) {
  CommandResult result;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return result;
  std::array<char, 4096> buffer;
  while (const std::size_t n = fread(buffer.data(), 1, buffer.size(), pipe)) result.output.append(buffer.data(), n);
  const int status = pclose(pipe);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return result;
}

/// Whether a file is as a schema in docs/ says. Where that can't be checked the test is skipped, whatever else it checks.
inline void expect_schema(const std::string& schema, const std::string& path) {
  const auto python = find_python("jsonschema");
  if (!python) GTEST_SKIP() << "no python3 with jsonschema here (Debian: python3-jsonschema)";
  const CommandResult checked = run_command(
      *python + " " TUBEBIN_SOURCE_DIR "/tests/validate_json.py " TUBEBIN_SOURCE_DIR "/docs/" + schema + " " + path);
  EXPECT_EQ(checked.exit_code, 0) << checked.output;
}

}  // namespace tubebin::testing
