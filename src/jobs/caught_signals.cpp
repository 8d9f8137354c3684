#include "jobs/caught_signals.hpp"

namespace tubebin::jobs {

CaughtSignals::CaughtSignals(void (*handler)(int), int flags) {
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    struct sigaction action {};
    sigaction(kSignals[i], nullptr, &previous_actions_[i]);
    if (previous_actions_[i].sa_handler == SIG_IGN) continue;
    action.sa_handler = handler;
    action.sa_flags = flags;
    sigaction(kSignals[i], &action, nullptr);
    caught_.push_back(kSignals[i]);
  }
}

CaughtSignals::~CaughtSignals() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &previous_actions_[i], nullptr);
}

}  // namespace tubebin::jobs
