#include "json_file.hpp"

#include <algorithm>
#include <cmath>

#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin {
namespace {

std::string excerpt(const Json& value) {
  const std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

}  // namespace

JsonPlace JsonPlace::at(const char* key) const {
  if (!value_.is_object()) fail(fmt::format("expected an object, found {}", excerpt(value_)));
  const auto member = value_.find(key);
  if (member == value_.end()) fail(fmt::format("'{}' is missing", key));
  return {*member, file_, pointer_ + "/" + key};
}

std::vector<JsonPlace> JsonPlace::elements() const {
  if (!value_.is_array()) fail(fmt::format("expected a list, found {}", excerpt(value_)));
  std::vector<JsonPlace> places;
  places.reserve(value_.size());
  for (const Json& element : value_)
    places.emplace_back(element, file_, fmt::format("{}/{}", pointer_, places.size()));
  return places;
}

std::vector<JsonPlace> JsonPlace::elements(std::size_t count) const {
  std::vector<JsonPlace> places = elements();
  if (places.size() != count) fail(fmt::format("expected a list of {}, found {}", count, excerpt(value_)));
  return places;
}

std::string JsonPlace::text() const {
  if (!value_.is_string()) fail(fmt::format("expected a text, found {}", excerpt(value_)));
  return value_.get<std::string>();
}

double JsonPlace::number() const {
  if (!value_.is_number()) fail(fmt::format("expected a number, found {}", excerpt(value_)));
  return value_.get<double>();
}

bool JsonPlace::flag() const {
  if (!value_.is_boolean()) fail(fmt::format("expected true or false, found {}", excerpt(value_)));
  return value_.get<bool>();
}

std::int64_t JsonPlace::integer(std::int64_t min, std::int64_t max) const {
  const bool is_whole =
      value_.is_number_integer() &&
      !(value_.is_number_unsigned() && value_.get<std::uint64_t>() > static_cast<std::uint64_t>(INT64_MAX));
  if (!is_whole || value_.get<std::int64_t>() < min || value_.get<std::int64_t>() > max)
    fail(fmt::format("expected a whole number from {} to {}, found {}", min, max, excerpt(value_)));
  return value_.get<std::int64_t>();
}

void JsonPlace::fail(const std::string& problem) const {
  throw_io_error("{}: {}{}{}", file_, pointer_, pointer_.empty() ? "" : ": ", problem);
}

Json read_json_file(const std::string& path) { return parse_json(read_file(path), path); }

Json parse_json(const std::string& text, const std::string& name) {
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    if (text.empty()) throw_io_error("{}: the file is empty, expected JSON", name);
    const std::size_t end = std::min(error.byte > 0 ? error.byte - 1 : 0, text.size());
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end), '\n');
    const std::size_t line_start = end == 0 ? std::string::npos : text.rfind('\n', end - 1);
    const std::size_t column = end - (line_start == std::string::npos ? 0 : line_start + 1) + 1;
    throw_io_error("{}:{}:{}: no valid JSON{}", name, line, column,
                   end >= text.size() ? ": the file ends too early" : "");
  }
}

}  // namespace tubebin
