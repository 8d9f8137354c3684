/// Names that come from outside, as of a scene, a file in it, or a pack.
#pragma once

#include <fmt/format.h>

#include <compare>
#include <string>
#include <string_view>

namespace tubebin {

/// A relative path that leads nowhere but beneath the folder it is used in: "A10/007", or "." for the folder itself. Made
/// from a text, it throws IoError where the text is anything else: absolute, with "..", with an empty or a hidden folder,
/// no UTF-8, with control characters, or too long for a file system.
class ConfinedPath {
 public:
  ConfinedPath() : text_(".") {}
  // NOLINTBEGIN(google-explicit-constructor): whoever takes a ConfinedPath may be given a text, which is checked then.
  ConfinedPath(std::string_view text);
  ConfinedPath(const std::string& text) : ConfinedPath(std::string_view(text)) {}
  ConfinedPath(const char* text) : ConfinedPath(std::string_view(text)) {}
  operator const std::string&() const { return text_; }
  // NOLINTEND(google-explicit-constructor)

  /// The same, and the error says where the text stands: "DIR/manifest.jsonl:12: '../x' is ...".
  static ConfinedPath parse(std::string_view text, const std::string& place);
  /// The same for the name of one file or folder: no '/', and not ".".
  static ConfinedPath parse_name(std::string_view text, const std::string& place);

  const std::string& str() const { return text_; }
  bool is_folder_itself() const { return text_ == "."; }
  /// "A10" of "A10/007"; "." of "A10".
  ConfinedPath parent() const;
  /// "007" of "A10/007".
  std::string name() const { return text_.substr(text_.rfind('/') + 1); }

  friend ConfinedPath operator/(const ConfinedPath& folder, const ConfinedPath& inner);
  friend auto operator<=>(const ConfinedPath&, const ConfinedPath&) = default;

 private:
  std::string text_;
};

}  // namespace tubebin

/// @cond
template <>
struct fmt::formatter<tubebin::ConfinedPath> : fmt::formatter<std::string_view> {
  auto format(const tubebin::ConfinedPath& path, fmt::format_context& context) const {
    return fmt::formatter<std::string_view>::format(path.str(), context);
  }
};
/// @endcond
