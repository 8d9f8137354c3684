/// Progress of something long, on stderr: a bar on a terminal, now and then a line otherwise.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace tubebin::jobs {

class Progress {
 public:
  enum class Style { automatic, none };

  /// `total` things called `noun` ("scenes") are to be done.
  Progress(std::size_t total, std::string noun, Style style);
  /// Leaves the bar's last state standing.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void count_done() { ++done_; }
  void count_reject() { ++rejects_; }
  /// Shows the state, if it is time to; call it often.
  void show();

 private:
  std::string status() const;
  void draw_bar();

  std::size_t total_;
  std::string noun_;
  bool is_shown_;
  bool is_terminal_;
  std::size_t done_ = 0;
  std::size_t rejects_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point last_shown_ = start_;
};

}  // namespace tubebin::jobs
