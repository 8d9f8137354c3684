/// Jobs in worker processes, so that a crash, a hang or a kill costs one attempt at one job and nothing else.
///
/// Each job is attempted until an attempt succeeds or `attempts_max` have failed. What a job yields depends on
/// (job, attempt) alone, never on the number of workers or on the order: a failed attempt k is followed by attempt
/// k + 1, while an attempt whose worker was killed from outside (kill -9, the out-of-memory killer) is made again
/// as it was.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace tubebin::jobs {

struct PoolOptions {
  int workers = 1;
  int attempts_max = 1;
  double attempt_time_limit = 120.0;  ///< seconds of wall-clock time; time in which all stood still doesn't count
};

/// What an attempt returns from its worker process.
struct AttemptResult {
  bool succeeded = false;
  std::string text;    ///< of a success: its result; of a failure: the reason in one word, to be counted
  std::string detail;  ///< of a failure: what happened, for people
  /// Of a success, or empty: what is left to wait for, as a disk. Runs in a thread beside the worker's next attempt
  /// and returns the result in the place of `text`. An exception from it ends the whole run.
  std::function<std::string()> finish;
};

inline AttemptResult successful_attempt(std::string text) { return {true, std::move(text), "", {}}; }
inline AttemptResult successful_attempt(std::function<std::string()> finish) {
  return {true, "", "", std::move(finish)};
}
inline AttemptResult failed_attempt(std::string reason, std::string detail) {
  return {false, std::move(reason), std::move(detail), {}};
}

struct FailedAttempt {
  int attempt = 0;     ///< from 0
  std::string reason;  ///< the attempt's own, or "crash", "timeout", "killed"
  std::string detail;

  const std::string& for_people() const { return detail.empty() ? reason : detail; }
};

struct JobOutcome {
  std::size_t job = 0;
  bool succeeded = false;
  std::string text;                   ///< of the attempt that succeeded
  std::vector<FailedAttempt> failed;  ///< in order
  double seconds = 0.0;               ///< wall-clock time of all its attempts, without `finish`
};

struct PoolReport {
  int signal = 0;  ///< that ended the run early (SIGINT, SIGTERM, SIGHUP); 0: all jobs were done
  std::size_t succeeded = 0;
  std::size_t failed = 0;
};

/// Runs in a worker process. An IoError or a ConfigError that it throws ends the whole run; any other exception
/// is a failed attempt with the reason "crash".
using Work = std::function<AttemptResult(std::size_t job, int attempt)>;

struct PoolEvents {
  /// In the calling process, as each job ends.
  std::function<void(const JobOutcome&)> on_finished;
  /// In the calling process, as each attempt fails.
  std::function<void(std::size_t job, const FailedAttempt&)> on_failed_attempt = [](auto, const auto&) {};
  /// In the calling process, a few times a second.
  std::function<void()> on_tick = [] {};
};

/// Runs all jobs. The caller must have no other threads, since workers are forked from it. Workers die with the
/// caller. After SIGINT, SIGTERM or SIGHUP running attempts get a second to end and the report says so.
/// Throws IoError or ConfigError as `work` or `on_finished` does, after all workers have ended.
PoolReport run_jobs(const std::vector<std::size_t>& jobs, const PoolOptions& options, const Work& work,
                    const PoolEvents& events);

/// Cores this process may use.
int available_cores();

}  // namespace tubebin::jobs
