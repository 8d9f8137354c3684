/// What every program does around its own work: it sees to its standard streams, parses its command line, and turns what
/// went wrong into a message and an exit code.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <string>

#include "help_text.hpp"
#include "standard_streams.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/text_scan.hpp"
#include "tubebin/core/utf8.hpp"

namespace tubebin {

/// CLI11 reads 010 as eight; here it is ten, as in every file that is read.
inline void read_integers_as_decimal(CLI::App& app) {
  const CLI::Validator strip_zeros(
      [](std::string& text) {
        const std::size_t digits = text.starts_with('-') || text.starts_with('+') ? 1 : 0;
        if (text.find_first_not_of("0123456789", digits) == std::string::npos)
          text.erase(digits, std::min(text.find_first_not_of('0', digits), text.size() - 1) - digits);
        return std::string();
      },
      "");
  for (CLI::Option* option : app.get_options())
    if (const std::string type = option->get_type_name(); type.starts_with("INT") || type.starts_with("UINT"))
      option->transform(strip_zeros);
}

/// A number of the command line: refused with what would be right. CLI11's own words for a range without an end are 309
/// digits long.
template <typename Number>
CLI::Validator number_of(const char* right, Number least) {
  return {[right, least](const std::string& word) {
            const std::optional<Number> number = to_number<Number>(word);
            return number && *number >= least && *number <= std::numeric_limits<Number>::max()
                       ? ""
                       : fmt::format("'{}' is not {}", excerpt(word), right);
          },
          ""};
}
inline CLI::Validator whole_number() { return number_of<std::uint64_t>("a whole number from 0 to 2^64 - 1", 0); }
inline CLI::Validator positive_number(const char* right) {
  return number_of<double>(right, std::numeric_limits<double>::denorm_min());
}

/// Paths go into JSON files and reports, which are UTF-8. Throws ConfigError.
inline void require_utf8(int argc, char** argv) {
  for (int i = 1; i < argc; ++i)
    if (!is_utf8(argv[i]))
      throw_config_error("argument {}: '{}' is no UTF-8 text; rename the path", i, excerpt(argv[i]));
}

/// For arguments that are understood one by one: the usage is told with the problem.
[[noreturn]] inline void throw_usage_error(const char* problem) {
  throw CLI::ParseError(problem, CLI::ExitCodes::RequiredError);
}

/// `run` returns the exit code of a command line that was understood.
template <typename Run>
int run_program(const char* name, CLI::App& app, int argc, char** argv, const Run& run) {
  const auto fail = [&](const char* problem, ExitCode code) {
    fmt::print(stderr, "{}: {}\n", name, problem);
    return static_cast<int>(code);
  };
  open_standard_streams();
  int code = 0;
  try {
    require_utf8(argc, argv);
    read_integers_as_decimal(app);
    app.name(name);
    app.formatter(std::make_shared<HelpInWords>());
    app.failure_message(describe_failure);
    app.parse(argc, argv);
    code = run();
  } catch (const CLI::ParseError& error) {
    code = app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::usage);
  } catch (const ConfigError& error) {
    code = fail(error.what(), ExitCode::usage);
  } catch (const std::bad_alloc&) {
    const std::string problem = fmt::format("out of memory in: {}", fmt::join(argv + 1, argv + argc, " "));
    code = fail(problem.c_str(), ExitCode::failed);
  } catch (const std::exception& error) {
    code = fail(error.what(), ExitCode::failed);
  }
  if (const std::string problem = close_standard_output(); !problem.empty())
    return fail(problem.c_str(), ExitCode::failed);
  return code;
}

}  // namespace tubebin
