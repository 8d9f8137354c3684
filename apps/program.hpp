/// What every program does around its own work: it parses its command line and turns what went wrong into a message and an
/// exit code.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "tubebin/core/error.hpp"

namespace tubebin {

/// `run` returns the exit code of a command line that was understood.
template <typename Run>
int run_program(const char* name, CLI::App& app, int argc, char** argv, const Run& run) {
  try {
    app.parse(argc, argv);
    return run();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::usage);
  } catch (const ConfigError& error) {
    fmt::print(stderr, "{}: {}\n", name, error.what());
    return static_cast<int>(ExitCode::usage);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", name, error.what());
    return static_cast<int>(ExitCode::failed);
  }
}

}  // namespace tubebin
