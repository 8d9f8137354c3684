// Signals that ask to stop, between runs of the worker pool.
#pragma once

#include "jobs/caught_signals.hpp"

namespace tubebin::jobs {

/// While it lives, SIGINT, SIGTERM and SIGHUP are noted instead of ending the process; one that was ignored stays so.
class StopNote {
 public:
  StopNote();

  /// The signal that came last, 0 if none did.
  static int received();

 private:
  CaughtSignals signals_;
};

}  // namespace tubebin::jobs
