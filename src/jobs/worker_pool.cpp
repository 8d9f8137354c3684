#include "tubebin/jobs/worker_pool.hpp"

#include <poll.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <deque>
#include <memory>
#include <optional>
#include <utility>

#include "jobs/caught_signals.hpp"
#include "jobs/worker_process.hpp"
#include "tubebin/core/error.hpp"

namespace tubebin::jobs {
namespace {

constexpr double kTickSeconds = 0.1;
constexpr double kGraceSeconds = 1.0;  // for running attempts, after a signal asked to stop
// An attempt that is killed from outside so often is too large for the machine's memory, say.
constexpr int kKillsMax = 5;

volatile std::sig_atomic_t received_signal = 0;
void note_signal(int signal) { received_signal = signal; }

/// Catches the signals that ask to stop. They are blocked except where `ppoll` waits, so none is missed.
class StopSignals {
 public:
  StopSignals() {
    received_signal = 0;
    caught_.emplace(note_signal, 0);
    sigset_t blocked;
    sigemptyset(&blocked);
    for (const int signal : caught_->caught()) sigaddset(&blocked, signal);
    sigprocmask(SIG_BLOCK, &blocked, &previous_mask_);
  }
  ~StopSignals() {
    caught_.reset();  // before unblocking, so that a signal that waits goes to whom it belongs
    sigprocmask(SIG_SETMASK, &previous_mask_, nullptr);
  }
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  const sigset_t& mask_while_waiting() const { return previous_mask_; }
  int received() const { return received_signal; }

 private:
  std::optional<CaughtSignals> caught_;
  sigset_t previous_mask_{};
};

/// Seconds in which this process ran: a pause of the whole run (Ctrl-Z, a suspended machine) counts as one tick.
class RunningClock {
 public:
  double now() {
    const auto time = std::chrono::steady_clock::now();
    seconds_ += std::min(std::chrono::duration<double>(time - last_).count(), 10.0 * kTickSeconds);
    last_ = time;
    return seconds_;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  double seconds_ = 0.0;
};

struct Job : JobOutcome {
  int kills = 0;  ///< of the current attempt, from outside
};

struct Worker {
  std::unique_ptr<WorkerProcess> process;
  std::optional<Job> job;  ///< in work
  double attempt_start = 0.0;
  std::optional<Job> finishing;  ///< computed, and not done until its `finish` has returned
  double finish_start = 0.0;

  bool busy() const { return job || finishing; }
};

class Pool {
 public:
  Pool(const std::vector<std::size_t>& jobs, const PoolOptions& options, const Work& work, const PoolEvents& events)
      : options_(options),
        work_(work),
        events_(events),
        workers_(std::min(jobs.size(), static_cast<std::size_t>(std::max(options.workers, 1)))) {
    for (const std::size_t job : jobs)
      waiting_.push_back({{.job = job, .succeeded = false, .text = "", .failed = {}, .seconds = 0.0}});
  }

  PoolReport run() {
    for (Worker& worker : workers_) give_next_job(worker);
    while (any_busy() && !stopped()) {
      wait_for_answers();
      for (Worker& worker : workers_) enforce_time_limit(worker);
      events_.on_tick();
    }
    report_.signal = any_busy() || !waiting_.empty() ? signals_.received() : 0;
    return report_;
  }

 private:
  bool any_busy() const {
    return std::any_of(workers_.begin(), workers_.end(), [](const Worker& worker) { return worker.busy(); });
  }

  bool stopping() const { return signals_.received() != 0; }

  bool stopped() {
    if (!stopping()) return false;
    if (!stop_time_) stop_time_ = clock_.now();
    return clock_.now() - *stop_time_ > kGraceSeconds;
  }

  void wait_for_answers() {
    std::vector<pollfd> sockets;
    for (const Worker& worker : workers_)
      sockets.push_back({.fd = worker.busy() ? worker.process->socket() : -1, .events = POLLIN, .revents = 0});
    const timespec timeout = {.tv_sec = 0, .tv_nsec = static_cast<long>(kTickSeconds * 1e9)};
    if (ppoll(sockets.data(), sockets.size(), &timeout, &signals_.mask_while_waiting()) <= 0) return;
    for (std::size_t i = 0; i < workers_.size(); ++i)
      if (sockets[i].revents != 0) handle_answer(workers_[i]);
  }

  void give_next_job(Worker& worker) {
    if (!waiting_.empty() && !stopping()) {
      worker.job = std::move(waiting_.front());
      waiting_.pop_front();
      return start_attempt(worker);
    }
    if (!worker.finishing) worker.process.reset();
  }

  void start_attempt(Worker& worker) {
    worker.attempt_start = clock_.now();
    const Attempt attempt{.job = worker.job->job, .number = static_cast<int>(worker.job->failed.size())};
    while (!worker.process || !worker.process->start(attempt)) {
      make_again(worker.finishing);  // a process that was killed while it finished a job takes that with it
      start_process(worker);
    }
  }

  void start_process(Worker& worker) {
    worker.process.reset();
    std::vector<int> others;
    for (const Worker& other : workers_)
      if (other.process) others.push_back(other.process->socket());
    worker.process = std::make_unique<WorkerProcess>(work_, others);
  }

  void handle_answer(Worker& worker) {
    const WorkerAnswer answer = worker.process->answer();
    switch (answer.kind) {
      case WorkerAnswer::Kind::failed:
        return fail_attempt(worker, answer.text, answer.detail);
      case WorkerAnswer::Kind::computed:
        return finish_beside_next(worker);
      case WorkerAnswer::Kind::succeeded:
        return succeed(worker, answer.text);
      case WorkerAnswer::Kind::io_error:
        throw IoError(answer.text);
      case WorkerAnswer::Kind::config_error:
        throw ConfigError(answer.text);
      case WorkerAnswer::Kind::died:
        return handle_death(worker);
    }
  }

  void finish_beside_next(Worker& worker) {
    worker.job->seconds += clock_.now() - worker.attempt_start;
    worker.finishing = std::exchange(worker.job, std::nullopt);
    worker.finish_start = clock_.now();
    give_next_job(worker);
  }

  void succeed(Worker& worker, const std::string& text) {
    worker.finishing->succeeded = true;
    worker.finishing->text = text;
    const JobOutcome outcome = *std::exchange(worker.finishing, std::nullopt);
    if (!worker.job) worker.process.reset();
    ++report_.succeeded;
    events_.on_finished(outcome);
  }

  void handle_death(Worker& worker) {
    const int signal = worker.process->wait();
    const bool from_outside = signal == SIGKILL || signal == SIGTERM;
    if (!from_outside)
      return lose_process(worker, "crash",
                          signal != 0
                              ? fmt::format("its process was ended by signal {} ({})", signal, strsignal(signal))
                              : "its process ended by itself");
    make_again_after_kill(worker);
  }

  /// What was in work is as good as before, and made again as it was.
  void make_again_after_kill(Worker& worker) {
    Job& current = worker.job ? *worker.job : *worker.finishing;
    if (++current.kills >= kKillsMax)
      return lose_process(worker, "killed", fmt::format("its process was killed {} times", kKillsMax));
    worker.process.reset();
    make_again(worker.finishing);
    if (stopping()) return make_again(worker.job);
    if (worker.job) return start_attempt(worker);
    give_next_job(worker);
  }

  void enforce_time_limit(Worker& worker) {
    const double now = clock_.now();
    // A process that was stopped, or a disk that hangs: no attempt's fault.
    if (worker.finishing && now - worker.finish_start > options_.attempt_time_limit) make_again_after_kill(worker);
    else if (worker.job && now - worker.attempt_start > options_.attempt_time_limit)
      lose_process(worker, "timeout", fmt::format("no result after {} s", options_.attempt_time_limit));
  }

  /// The process ended, or must end, by its attempt's fault. A job that it was finishing is innocent, unless it was
  /// alone.
  void lose_process(Worker& worker, const std::string& reason, const std::string& detail) {
    worker.process.reset();
    if (worker.job) {
      make_again(worker.finishing);
    } else {
      worker.job = std::exchange(worker.finishing, std::nullopt);
      worker.attempt_start = clock_.now();
    }
    fail_attempt(worker, reason, detail);
  }

  void fail_attempt(Worker& worker, const std::string& reason, const std::string& detail) {
    Job& job = *worker.job;
    job.seconds += clock_.now() - worker.attempt_start;
    job.failed.push_back({static_cast<int>(job.failed.size()), reason, detail});
    job.kills = 0;
    events_.on_failed_attempt(job.job, job.failed.back());
    if (static_cast<int>(job.failed.size()) >= options_.attempts_max) return give_up(worker);
    if (stopping()) return make_again(worker.job);
    start_attempt(worker);
  }

  void give_up(Worker& worker) {
    const JobOutcome outcome = *std::exchange(worker.job, std::nullopt);
    give_next_job(worker);
    ++report_.failed;
    events_.on_finished(outcome);
  }

  /// The job goes back to those that wait, its current attempt to be made once more.
  void make_again(std::optional<Job>& job) {
    if (job) waiting_.push_front(*std::exchange(job, std::nullopt));
  }

  StopSignals signals_;
  RunningClock clock_;
  std::deque<Job> waiting_;
  PoolOptions options_;
  const Work& work_;
  const PoolEvents& events_;
  std::vector<Worker> workers_;
  std::optional<double> stop_time_;
  PoolReport report_;
};

}  // namespace

PoolReport run_jobs(const std::vector<std::size_t>& jobs, const PoolOptions& options, const Work& work,
                    const PoolEvents& events) {
  return Pool(jobs, options, work, events).run();
}

int available_cores() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  if (sched_getaffinity(0, sizeof(cores), &cores) != 0) return 1;
  return std::max(CPU_COUNT(&cores), 1);
}

}  // namespace tubebin::jobs
