#include "tubebin/core/shell_word.hpp"

namespace tubebin {

std::string shell_path(const std::string& path) {
  std::string text = path.starts_with('-') ? "./" + path : path;  // else an option to any program
  constexpr const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./+-=:,@%";
  if (!text.empty() && text.find_first_not_of(plain) == std::string::npos) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

}  // namespace tubebin
