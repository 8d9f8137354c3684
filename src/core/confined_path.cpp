#include "tubebin/core/confined_path.hpp"

#include <algorithm>
#include <optional>

#include "tubebin/core/error.hpp"
#include "tubebin/core/text_scan.hpp"
#include "tubebin/core/utf8.hpp"

namespace tubebin {
namespace {

// Room is left for the longer names that files have while they are written (a file system takes 255 bytes).
constexpr std::size_t kLongestName = 150;
constexpr std::size_t kLongestPath = 1000;

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

/// What is wrong with one folder's or file's name, if anything is.
std::optional<std::string> problem_of_name(std::string_view name) {
  if (name.empty()) return "begins or ends with '/', has two in a row, or is empty";
  if (name == "..") return "leads out of its folder";
  if (name.front() == '.') return "has a hidden part";
  if (name.size() > kLongestName) return fmt::format("has a part of more than {} bytes", kLongestName);
  return std::nullopt;
}

std::optional<std::string> problem_of(std::string_view text) {
  if (text == ".") return std::nullopt;
  if (text.size() > kLongestPath) return fmt::format("has more than {} bytes", kLongestPath);
  if (!is_utf8(text)) return "is no UTF-8 text";
  if (std::ranges::any_of(text, is_control)) return "has control characters";
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('/', begin), text.size());
    if (auto problem = problem_of_name(text.substr(begin, end - begin))) return problem;
    begin = end + 1;
  }
  return std::nullopt;
}

void require_valid(std::string_view text, const std::string& place) {
  if (const auto problem = problem_of(text))
    throw_io_error("{}'{}' {}; valid: names of a folder or file beneath this one, as A10/007",
                   place.empty() ? "" : place + ": ", excerpt(text), *problem);
}

}  // namespace

ConfinedPath::ConfinedPath(std::string_view text) : text_(text) { require_valid(text, ""); }

ConfinedPath ConfinedPath::parse(std::string_view text, const std::string& place) {
  require_valid(text, place);
  return {text};
}

ConfinedPath ConfinedPath::parse_name(std::string_view text, const std::string& place) {
  ConfinedPath path = parse(text, place);
  if (path.is_folder_itself() || text.find('/') != std::string_view::npos)
    throw_io_error("{}: '{}' is not valid; valid: one name, without '/'", place, excerpt(text));
  return path;
}

ConfinedPath ConfinedPath::parent() const {
  const std::size_t slash = text_.rfind('/');
  return slash == std::string::npos ? ConfinedPath() : ConfinedPath(text_.substr(0, slash));
}

ConfinedPath operator/(const ConfinedPath& folder, const ConfinedPath& inner) {
  if (folder.is_folder_itself()) return inner;
  return inner.is_folder_itself() ? folder : ConfinedPath(folder.text_ + "/" + inner.text_);
}

}  // namespace tubebin
