// The signals that ask to stop.
#pragma once

#include <array>
#include <csignal>
#include <vector>

namespace tubebin::jobs {

/// While it lives, SIGINT, SIGTERM and SIGHUP go to a handler; one that was ignored stays so, as nohup asks.
class CaughtSignals {
 public:
  /// `flags`: of sigaction().
  CaughtSignals(void (*handler)(int), int flags);
  ~CaughtSignals();
  CaughtSignals(const CaughtSignals&) = delete;
  CaughtSignals& operator=(const CaughtSignals&) = delete;

  const std::vector<int>& caught() const { return caught_; }

 private:
  static constexpr std::array<int, 3> kSignals = {SIGINT, SIGTERM, SIGHUP};
  std::array<struct sigaction, kSignals.size()> previous_actions_{};
  std::vector<int> caught_;
};

}  // namespace tubebin::jobs
