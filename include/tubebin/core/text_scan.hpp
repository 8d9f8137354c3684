/// Lines, words and numbers of a text that may be anything.
#pragma once

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tubebin {

/// Hands out a text line by line, without "\n" or "\r\n", and counts.
class LineScanner {
 public:
  explicit LineScanner(std::string_view text, std::size_t lines_before = 0) : text_(text), number_(lines_before) {}

  /// The next line; nothing at the end of the text.
  std::optional<std::string_view> next() {
    if (offset_ >= text_.size()) return std::nullopt;
    const std::size_t end = std::min(text_.find('\n', offset_), text_.size());
    std::string_view line = text_.substr(offset_, end - offset_);
    if (line.ends_with('\r')) line.remove_suffix(1);
    offset_ = std::min(end + 1, text_.size());
    ++number_;
    return line;
  }

  /// The next line that is not blank; nothing at the end of the text.
  std::optional<std::string_view> next_filled() {
    std::optional<std::string_view> line = next();
    while (line && line->find_first_not_of(" \t\v\f\r") == std::string_view::npos) line = next();
    return line;
  }

  std::size_t number() const { return number_; }                    ///< of the line handed out last, from 1
  std::size_t offset() const { return offset_; }                    ///< where the next line starts
  std::size_t remaining() const { return text_.size() - offset_; }  ///< bytes

 private:
  std::string_view text_;
  std::size_t offset_ = 0;
  std::size_t number_;
};

/// Takes the next word off the line's front; empty at its end.
inline std::string_view take_word(std::string_view& line) {
  constexpr std::string_view kBlank = " \t\v\f\r";
  const std::size_t begin = std::min(line.find_first_not_of(kBlank), line.size());
  const std::size_t end = std::min(line.find_first_of(kBlank, begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

inline std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) words.push_back(word);
  return words;
}

/// The whole word as a number, or nothing: also where it is beyond the type.
template <typename Number>
std::optional<Number> to_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// What a message can show of a text that may be anything.
inline std::string excerpt(std::string_view text) {
  constexpr std::size_t kShown = 40;
  std::string shown(text.substr(0, kShown));
  for (char& letter : shown)
    if (letter < ' ' || letter > '~') letter = '?';
  return text.size() > kShown ? shown + "..." : shown;
}

}  // namespace tubebin
