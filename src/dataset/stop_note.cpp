#include "stop_note.hpp"

#include <array>
#include <csignal>

namespace tubebin {
namespace {

constexpr std::array<int, 3> kSignals = {SIGINT, SIGTERM, SIGHUP};
std::array<struct sigaction, kSignals.size()> previous_actions;
volatile std::sig_atomic_t noted_signal = 0;
void note(int signal) { noted_signal = signal; }

}  // namespace

StopNote::StopNote() {
  noted_signal = 0;
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    struct sigaction action {};
    sigaction(kSignals[i], nullptr, &previous_actions[i]);
    if (previous_actions[i].sa_handler == SIG_IGN) continue;  // as nohup asks
    action.sa_handler = note;
    action.sa_flags = SA_RESTART;
    sigaction(kSignals[i], &action, nullptr);
  }
}

StopNote::~StopNote() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &previous_actions[i], nullptr);
}

int StopNote::received() { return noted_signal; }

}  // namespace tubebin
