/// A batch: many jobs in worker processes, of which earlier runs may have done some, with progress on stderr.
#pragma once

#include <functional>
#include <string>

#include "tubebin/jobs/progress.hpp"
#include "tubebin/jobs/worker_pool.hpp"

namespace tubebin::jobs {

struct Batch {
  std::size_t size = 0;  ///< jobs, those that are done included
  std::string noun;      ///< that the progress calls them: "scenes"
  PoolOptions pool;
  Progress::Style progress = Progress::Style::automatic;
  Progress* shared_progress = nullptr;  ///< of several batches, instead of one of its own
  std::function<bool(std::size_t job)> is_done = [](std::size_t) { return false; };
  Work work;
  std::function<void(const JobOutcome&)> on_finished;  ///< in the calling process, as each job ends
  std::function<void(std::size_t job, const FailedAttempt&)> on_failed_attempt = [](auto, const auto&) {};
};

struct BatchReport {
  std::size_t done_before = 0;
  std::size_t made = 0;
  int signal = 0;        ///< that ended it early, 0 if none did
  double seconds = 0.0;  ///< of wall-clock time
};

/// Does the jobs that are not done. Throws as run_jobs does.
BatchReport run_batch(const Batch& batch);

}  // namespace tubebin::jobs
