#include "tubebin/jobs/progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

namespace tubebin::jobs {
namespace {

using Seconds = std::chrono::duration<double>;

constexpr Seconds kBarInterval{0.1};
constexpr Seconds kLineInterval{10.0};
constexpr std::size_t kBarWidth = 20;
constexpr const char* kEraseLine = "\r\033[K";

/// "1:02:03" or "2:03"
std::string clock_text(double seconds) {
  const auto whole = std::llround(seconds);
  if (whole >= 3600) return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

/// A line that is longer could not be erased.
std::size_t terminal_columns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col : 80;
}

}  // namespace

Progress::Progress(std::size_t total, std::string noun, Style style)
    : total_(total),
      noun_(std::move(noun)),
      is_shown_(style == Style::automatic && total > 0),
      is_terminal_(isatty(STDERR_FILENO) == 1) {
  if (is_shown_ && is_terminal_) draw_bar();
}

Progress::~Progress() {
  if (!is_shown_) return;
  if (is_terminal_) draw_bar();
  fmt::print(stderr, "{}\n", is_terminal_ ? "" : status());
}

std::string Progress::status() const {
  const double elapsed = Seconds(std::chrono::steady_clock::now() - start_).count();
  const double rate = elapsed > 0.0 ? static_cast<double>(done_) / elapsed : 0.0;
  const std::string time = done_ == total_ ? fmt::format("took {}", clock_text(elapsed))
                           : done_ == 0    ? std::string("ETA --:--")
                                        : fmt::format("ETA {}", clock_text(static_cast<double>(total_ - done_) / rate));
  const std::string rejects = rejects_ > 0 ? fmt::format(" {} rejects,", rejects_) : "";
  return fmt::format("{}/{} {}, {:.1f} {}/s,{} {}", done_, total_, noun_, rate, noun_, rejects, time);
}

void Progress::draw_bar() {
  const std::size_t filled = total_ > 0 ? kBarWidth * done_ / total_ : 0;
  const std::string bar =
      fmt::format("[{}{}] {}", std::string(filled, '#'), std::string(kBarWidth - filled, ' '), status());
  fmt::print(stderr, "{}{}", kEraseLine, bar.substr(0, terminal_columns() - 1));
  std::fflush(stderr);
}

void Progress::show() {
  if (!is_shown_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_shown_ < (is_terminal_ ? kBarInterval : kLineInterval)) return;
  last_shown_ = now;
  if (is_terminal_) draw_bar();
  else fmt::print(stderr, "{}\n", status());
}

}  // namespace tubebin::jobs
