/// --help in words: what a value is, from where to where it may go, what it is where it is not given.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "tubebin/core/text_scan.hpp"

namespace tubebin {

/// CLI11 describes an option's value as "INT:INT in [1 - 1024]" or "TEXT:{bop,coco}".
class HelpInWords : public CLI::Formatter {
 public:
  HelpInWords() { label("Positionals", "Arguments"); }

  /// With the options that are needed.
  std::string make_usage(const CLI::App* app, std::string name) const override {
    std::string usage = Formatter::make_usage(app, name);
    usage.erase(usage.find_last_not_of('\n') + 1);
    for (const CLI::Option* option : app->get_options())
      if (option->get_required() && !option->get_positional())
        usage += fmt::format(" {} {}", option->get_name(), value_of(*option));
    return usage + "\n";
  }

 private:
  static constexpr std::size_t kColumn = 30;  // where CLI11 begins descriptions
  static constexpr std::size_t kLineEnd = 110;

  static std::string between(const std::string& text, const char* open, const char* close) {
    const std::size_t start = text.find(open);
    const std::size_t end = text.rfind(close);
    if (start == std::string::npos || end == std::string::npos) return "";
    const std::size_t first = start + std::string(open).size();
    return text.substr(first, end - first);
  }

  /// "1e+06" as "1000000".
  static std::string plain(const std::string& number) {
    const auto value = to_number<double>(number);
    return value ? fmt::format("{:.15g}", *value) : number;
  }

  static std::string value_of(const CLI::Option& option) {
    const std::string type = option.get_type_name();
    if (const std::string choices = between(type, "{", "}"); !choices.empty())
      return CLI::detail::find_and_replace(choices, ",", "|");
    if (type.starts_with("INT") || type.starts_with("UINT")) return "N";
    if (type.starts_with("FLOAT")) return "NUMBER";
    return type;
  }

  static std::string limits_of(const CLI::Option& option) {
    const std::string range = between(option.get_type_name(), " in [", "]");
    const std::size_t middle = range.find(" - ");
    return middle == std::string::npos
               ? ""
               : fmt::format("{} to {}", plain(range.substr(0, middle)), plain(range.substr(middle + 3)));
  }

  static std::string names_of(const std::set<CLI::Option*>& options) {
    std::vector<std::string> names;
    for (const CLI::Option* option : options) names.push_back(option->get_name());
    std::sort(names.begin(), names.end());
    return CLI::detail::join(names, ", ");
  }

  std::string make_option_opts(const CLI::Option* option) const override {
    if (option->get_positional() || option->get_type_size() == 0) return "";
    const std::string value = value_of(*option);
    return value.empty() ? "" : " " + value;
  }

  std::string make_option_desc(const CLI::Option* option) const override {
    std::string text = option->get_description();
    const auto add = [&](const char* words, const std::string& value) {
      if (!value.empty()) text += fmt::format("; {}{}", words, value);
    };
    add("", limits_of(*option));
    if (option->get_required()) text += "; needed";
    if (option->get_type_size() != 0) add("default ", option->get_default_str());
    add("else ", option->get_envname().empty() ? "" : "$" + option->get_envname());
    add("only with ", names_of(option->get_needs()));
    add("not with ", names_of(option->get_excludes()));
    return wrapped(text);
  }

  static std::string wrapped(const std::string& text) {
    std::string lines;
    std::size_t column = kColumn;
    for (const std::string& word : CLI::detail::split(text, ' ')) {
      if (column > kColumn && column + 1 + word.size() > kLineEnd) {
        lines += '\n';
        column = kColumn;
      }
      if (column > kColumn) lines += ' ', ++column;
      lines += word;
      column += word.size();
    }
    return lines;
  }
};

/// Words that nobody knows come before needed options, which CLI11 misses first: one of these may be misspelled.
inline std::string problem_of(const CLI::App& app, const CLI::Error& error) {
  const std::vector<std::string> unknown = app.remaining();
  const auto code = static_cast<CLI::ExitCodes>(error.get_exit_code());
  const bool may_be_misspelled = code == CLI::ExitCodes::RequiredError || code == CLI::ExitCodes::ExtrasError;
  return may_be_misspelled && !unknown.empty() ? "not expected: " + CLI::detail::join(unknown, " ") : error.what();
}

/// Two lines under what is wrong.
inline std::string describe_failure(const CLI::App* app, const CLI::Error& error) {
  const std::string help = app->help();
  const std::size_t usage = help.find("Usage:");
  // Every option that CLI11 converts is a number.
  return fmt::format("{}: {}{}\n{}\nSee {} --help.\n", app->get_name(), problem_of(*app, error),
                     error.get_name() == "ConversionError" ? "; a number is needed there" : "",
                     help.substr(usage, help.find('\n', usage) - usage), app->get_name());
}

}  // namespace tubebin
