#include "jobs/stop_note.hpp"

namespace tubebin::jobs {
namespace {

volatile std::sig_atomic_t noted_signal = 0;
void note(int signal) { noted_signal = signal; }

}  // namespace

StopNote::StopNote() : signals_((noted_signal = 0, note), SA_RESTART) {}

int StopNote::received() { return noted_signal; }

}  // namespace tubebin::jobs
