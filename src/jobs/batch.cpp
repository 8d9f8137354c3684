#include "tubebin/jobs/batch.hpp"

#include <chrono>
#include <optional>

namespace tubebin::jobs {

BatchReport run_batch(const Batch& batch) {
  const auto start = std::chrono::steady_clock::now();
  std::vector<std::size_t> missing;
  for (std::size_t job = 0; job < batch.size; ++job)
    if (!batch.is_done(job)) missing.push_back(job);

  std::optional<Progress> own;
  Progress& progress =
      batch.shared_progress ? *batch.shared_progress : own.emplace(missing.size(), batch.noun, batch.progress);
  const PoolEvents events{.on_finished =
                              [&](const JobOutcome& outcome) {
                                batch.on_finished(outcome);
                                progress.count_done();
                              },
                          .on_failed_attempt =
                              [&](std::size_t job, const FailedAttempt& attempt) {
                                batch.on_failed_attempt(job, attempt);
                                if (batch.pool.attempts_max > 1)
                                  progress.count_reject();  // else it is the job that failed
                              },
                          .on_tick = [&] { progress.show(); }};
  const PoolReport pool = run_jobs(missing, batch.pool, batch.work, events);
  return {.done_before = batch.size - missing.size(),
          .made = pool.succeeded,
          .signal = pool.signal,
          .seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()};
}

}  // namespace tubebin::jobs
