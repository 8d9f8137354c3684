#include "tubebin/jobs/worker_pool.hpp"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <map>
#include <numeric>

#include "support/program.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin::jobs {
namespace {

using ::testing::HasSubstr;

std::vector<std::size_t> jobs_up_to(std::size_t count) {
  std::vector<std::size_t> jobs(count);
  std::iota(jobs.begin(), jobs.end(), std::size_t{0});
  return jobs;
}

struct PoolRun {
  PoolReport report;
  std::map<std::size_t, JobOutcome> outcomes;
};

PoolRun run(std::size_t job_count, const PoolOptions& options, const Work& work) {
  PoolRun result;
  const PoolEvents events{.on_finished = [&](const JobOutcome& outcome) {
    EXPECT_FALSE(result.outcomes.contains(outcome.job)) << "job " << outcome.job << " ended twice";
    result.outcomes[outcome.job] = outcome;
  }};
  result.report = run_jobs(jobs_up_to(job_count), options, work, events);
  return result;
}

void expect_no_children() {
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD);
}

AttemptResult success(const std::string& text) { return successful_attempt(text); }

TEST(WorkerPool, RunsEveryJobOnceInWorkerProcesses) {
  const pid_t here = getpid();
  const PoolRun r = run(100, {.workers = 4}, [&](std::size_t job, int) {
    return success(fmt::format("{} {}", job * job, getpid() != here));
  });
  EXPECT_EQ(r.report.succeeded, 100u);
  ASSERT_EQ(r.outcomes.size(), 100u);
  for (const auto& [job, outcome] : r.outcomes) EXPECT_EQ(outcome.text, fmt::format("{} true", job * job));
  expect_no_children();
}

TEST(WorkerPool, DoesNothingWithoutJobs) { EXPECT_EQ(run(0, {.workers = 2}, nullptr).report.succeeded, 0u); }

TEST(WorkerPool, RetriesFailuresWithTheNextAttemptUntilTheyAreTooMany) {
  const PoolRun r = run(10, {.workers = 3, .attempts_max = 5}, [](std::size_t job, int attempt) {
    if (attempt < static_cast<int>(job)) return failed_attempt("outside", fmt::format("tube {}", attempt));
    return success(fmt::format("{}", attempt));
  });
  EXPECT_EQ(r.report.succeeded, 5u);
  EXPECT_EQ(r.report.failed, 5u);
  for (const auto& [job, outcome] : r.outcomes) {
    EXPECT_EQ(outcome.succeeded, job < 5);
    ASSERT_EQ(outcome.failed.size(), std::min<std::size_t>(job, 5));
    for (std::size_t k = 0; k < outcome.failed.size(); ++k) {
      EXPECT_EQ(outcome.failed[k].attempt, static_cast<int>(k));
      EXPECT_EQ(outcome.failed[k].reason, "outside");
      EXPECT_EQ(outcome.failed[k].detail, fmt::format("tube {}", k));
    }
  }
}

TEST(WorkerPool, CountsACrashAsAFailedAttempt) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE}) {
    const PoolRun r = run(6, {.workers = 2, .attempts_max = 3}, [&](std::size_t job, int attempt) {
      if (job % 2 == 0 && attempt == 0) {
        struct sigaction to_default {};  // a sanitizer would report it at length
        to_default.sa_handler = SIG_DFL;
        sigaction(signal, &to_default, nullptr);
        raise(signal);
      }
      return success("done");
    });
    EXPECT_EQ(r.report.succeeded, 6u);
    ASSERT_EQ(r.outcomes.at(2).failed.size(), 1u);
    EXPECT_EQ(r.outcomes.at(2).failed[0].reason, "crash");
    EXPECT_THAT(r.outcomes.at(2).failed[0].detail, HasSubstr(std::to_string(signal)));
    EXPECT_TRUE(r.outcomes.at(3).failed.empty());
  }
}

TEST(WorkerPool, CountsAnExitAndAnUnexpectedExceptionAsCrashes) {
  const PoolRun r = run(3, {.workers = 1, .attempts_max = 1}, [](std::size_t job, int) -> AttemptResult {
    if (job == 0) _exit(0);
    if (job == 2) throw std::bad_alloc();
    throw std::logic_error("no such tube");
  });
  EXPECT_EQ(r.outcomes.at(0).failed.at(0).reason, "crash");
  EXPECT_EQ(r.outcomes.at(1).failed.at(0).reason, "crash");
  EXPECT_EQ(r.outcomes.at(1).failed.at(0).detail, "no such tube");
  EXPECT_EQ(r.outcomes.at(2).failed.at(0).detail, "out of memory");
}

TEST(WorkerPool, EndsAHangAtTheTimeLimit) {
  const PoolRun r =
      run(3, {.workers = 2, .attempts_max = 2, .attempt_time_limit = 0.3}, [](std::size_t job, int attempt) {
        while (job == 1 && attempt == 0) pause();
        return success("done");
      });
  EXPECT_EQ(r.report.succeeded, 3u);
  ASSERT_EQ(r.outcomes.at(1).failed.size(), 1u);
  EXPECT_EQ(r.outcomes.at(1).failed[0].reason, "timeout");
  expect_no_children();
}

TEST(WorkerPool, MakesAnAttemptAgainThatWasKilledFromOutside) {
  const testing::TemporaryFolder folder;
  const PoolRun r = run(8, {.workers = 2, .attempts_max = 1}, [&](std::size_t job, int attempt) {
    const std::string mark = folder / std::to_string(job);
    if (!testing::fs::exists(mark)) {
      testing::write_text(mark, "");
      raise(SIGKILL);
    }
    return success(std::to_string(attempt));
  });
  EXPECT_EQ(r.report.succeeded, 8u);
  for (const auto& [job, outcome] : r.outcomes) {
    EXPECT_EQ(outcome.text, "0");
    EXPECT_TRUE(outcome.failed.empty());
  }
}

TEST(WorkerPool, GivesUpAnAttemptThatIsKilledAgainAndAgain) {
  const PoolRun r = run(1, {.workers = 1, .attempts_max = 2}, [&](std::size_t, int attempt) {
    if (attempt == 0) raise(SIGKILL);
    return success("done");
  });
  ASSERT_EQ(r.outcomes.at(0).failed.size(), 1u);
  EXPECT_EQ(r.outcomes.at(0).failed[0].reason, "killed");
  EXPECT_TRUE(r.outcomes.at(0).succeeded);
}

TEST(WorkerPool, YieldsTheSameForAnyNumberOfWorkers) {
  const auto work = [](std::size_t job, int attempt) -> AttemptResult {
    if ((job + static_cast<std::size_t>(attempt)) % 3 == 0) {
      signal(SIGABRT, SIG_DFL);
      abort();
    }
    return success(fmt::format("{}/{}", job, attempt));
  };
  const PoolRun one = run(30, {.workers = 1, .attempts_max = 4}, work);
  const PoolRun four = run(30, {.workers = 4, .attempts_max = 4}, work);
  for (const auto& [job, outcome] : one.outcomes) {
    EXPECT_EQ(outcome.text, four.outcomes.at(job).text);
    EXPECT_EQ(outcome.failed.size(), four.outcomes.at(job).failed.size());
  }
}

TEST(WorkerPool, EndsTheRunOnIoAndConfigErrors) {
  EXPECT_THROW(run(5, {.workers = 2}, [](std::size_t, int) -> AttemptResult { throw IoError("disk full"); }), IoError);
  EXPECT_THROW(run(5, {.workers = 2}, [](std::size_t, int) -> AttemptResult { throw ConfigError("no"); }), ConfigError);
  expect_no_children();
}

TEST(WorkerPool, EndsWorkersWhenTheCallersBookkeepingFails) {
  const PoolEvents events{.on_finished = [](const JobOutcome&) { throw IoError("manifest"); }};
  EXPECT_THROW(run_jobs(
                   jobs_up_to(9), {.workers = 3}, [](std::size_t, int) { return success(""); }, events),
               IoError);
  expect_no_children();
}

TEST(WorkerPool, StopsOnASignalAndSaysWhichJobsAreLeft) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    std::size_t finished = 0;
    const PoolEvents events{.on_finished = [&](const JobOutcome&) {
      if (++finished == 3) raise(signal);
    }};
    const auto work = [](std::size_t job, int) {
      while (job >= 10) pause();
      return success("");
    };
    const PoolReport report = run_jobs(jobs_up_to(1000), {.workers = 2}, work, events);
    EXPECT_EQ(report.signal, signal);
    EXPECT_EQ(report.succeeded, finished);
    EXPECT_LE(report.succeeded, 10u);
    expect_no_children();
  }
}

TEST(WorkerPool, HandsOverLongResultsWhole) {
  const auto text_of = [](std::size_t job) { return std::string(200'000 * job + job, static_cast<char>('a' + job)); };
  const PoolRun r = run(8, {.workers = 2, .attempts_max = 2}, [&](std::size_t job, int attempt) {
    // Failures come between the parts of the result before.
    return attempt == 0 && job % 2 == 1 ? failed_attempt("bad", "luck") : success(text_of(job));
  });
  for (std::size_t job = 0; job < 8; ++job) EXPECT_EQ(r.outcomes.at(job).text, text_of(job)) << job;
}

/// Work whose `finish` waits until the next attempt has begun: it would never end if both didn't run side by side.
Work finishing_beside_the_next(const testing::TemporaryFolder& folder, std::size_t job_count) {
  return [&folder, job_count](std::size_t job, int) {
    testing::write_text(folder / std::to_string(job), "begun");
    return successful_attempt([&folder, job, job_count] {
      while (job + 1 < job_count && !testing::fs::exists(folder / std::to_string(job + 1))) usleep(1000);
      return fmt::format("finished {}", job);
    });
  };
}

TEST(WorkerPool, FinishesAnAttemptBesideTheNext) {
  const testing::TemporaryFolder folder;
  const PoolRun r = run(10, {.workers = 1}, finishing_beside_the_next(folder, 10));
  EXPECT_EQ(r.report.succeeded, 10u);
  for (const auto& [job, outcome] : r.outcomes) EXPECT_EQ(outcome.text, fmt::format("finished {}", job));
}

TEST(WorkerPool, ACrashCostsTheJobThatIsBeingFinishedNothing) {
  const testing::TemporaryFolder folder;
  const PoolRun r = run(2, {.workers = 1, .attempts_max = 2}, [&](std::size_t job, int attempt) {
    if (job == 1 && attempt == 0) {
      while (!testing::fs::exists(folder / "0")) usleep(1000);
      signal(SIGABRT, SIG_DFL);
      abort();
    }
    return successful_attempt([&folder, job, attempt] {
      const std::string mark = folder / std::to_string(job);
      const bool is_first_time = !testing::fs::exists(mark);
      testing::write_text(mark, "");
      while (job == 0 && is_first_time) pause();  // the other job's crash ends it
      return std::to_string(attempt);
    });
  });
  EXPECT_EQ(r.outcomes.at(0).text, "0");
  EXPECT_TRUE(r.outcomes.at(0).failed.empty());
  EXPECT_EQ(r.outcomes.at(1).text, "1");
  EXPECT_EQ(r.outcomes.at(1).failed.size(), 1u);
}

/// Nothing that was computed is lost, and nobody waits for ever, where a process stands still while it finishes its last job.
TEST(WorkerPool, MakesAnAttemptAgainWhoseProcessStandsStillWhileItFinishes) {
  const testing::TemporaryFolder folder;
  const PoolRun r =
      run(3, {.workers = 2, .attempts_max = 1, .attempt_time_limit = 0.3}, [&](std::size_t job, int attempt) {
        return successful_attempt([&folder, job, attempt]() -> std::string {
          const std::string mark = folder / std::to_string(job);
          if (!testing::fs::exists(mark)) {
            testing::write_text(mark, "");
            raise(SIGSTOP);
          }
          return std::to_string(attempt);
        });
      });
  EXPECT_EQ(r.report.succeeded, 3u);
  for (const auto& [job, outcome] : r.outcomes)
    EXPECT_EQ(outcome.text, "0") << "the same attempt, and so the same bytes";
  expect_no_children();
}

TEST(WorkerPool, GivesUpAJobThatNeverFinishes) {
  const PoolRun r = run(1, {.workers = 1, .attempts_max = 1, .attempt_time_limit = 0.1}, [](std::size_t, int) {
    return successful_attempt([]() -> std::string {
      raise(SIGSTOP);
      return "never";
    });
  });
  EXPECT_EQ(r.report.failed, 1u);
  EXPECT_EQ(r.outcomes.at(0).failed.back().reason, "killed");
  expect_no_children();
}

TEST(WorkerPool, EndsTheRunWhenFinishingFails) {
  const auto work = [](std::size_t, int) {
    return successful_attempt([]() -> std::string { throw IoError("disk full"); });
  };
  EXPECT_THROW(run(5, {.workers = 2}, work), IoError);
  expect_no_children();
}

}  // namespace
}  // namespace tubebin::jobs
