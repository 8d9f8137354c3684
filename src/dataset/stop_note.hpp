// Signals that ask to stop, between runs of the worker pool.
#pragma once

namespace tubebin {

/// While it lives, SIGINT, SIGTERM and SIGHUP are noted instead of ending the process; one that was ignored stays so.
class StopNote {
 public:
  StopNote();
  ~StopNote();
  StopNote(const StopNote&) = delete;
  StopNote& operator=(const StopNote&) = delete;

  /// The signal that came last, 0 if none did.
  static int received();
};

}  // namespace tubebin
