/// One forked worker process and the socket to it. Messages keep their boundaries (SOCK_SEQPACKET).
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

#include "tubebin/core/file_descriptor.hpp"
#include "tubebin/jobs/worker_pool.hpp"

namespace tubebin::jobs {

struct Attempt {
  std::size_t job = 0;
  int number = 0;
};

/// How a worker answered or ended.
struct WorkerAnswer {
  enum class Kind {
    failed,     ///< the attempt: `text` is the reason, `detail` what happened
    computed,   ///< the attempt succeeded and is being finished; the worker takes the next one
    succeeded,  ///< the attempt that was being finished: `text` is its result
    io_error,   ///< `text` is the message, as of the next
    config_error,
    died
  } kind = Kind::died;
  std::string text;
  std::string detail;
};

class WorkerProcess {
 public:
  /// Forks. `others` are the sockets of the caller's other workers, which the new process must not keep open.
  WorkerProcess(const Work& work, const std::vector<int>& others);
  /// Kills the process where it still runs, and waits for its end.
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  /// Readable when the worker answered or died.
  int socket() const { return socket_.get(); }
  /// Hands over an attempt, the next one as soon as the last is computed. False where the worker is dead already.
  bool start(const Attempt& attempt);
  WorkerAnswer answer();
  void kill();
  /// Waits for the end of a process that died or was killed: the signal that ended it, or 0.
  int wait();

 private:
  FileDescriptor socket_;
  pid_t process_ = -1;
  std::string begun_result_;  ///< what has come of one that takes several messages
  std::optional<int> end_signal_;
};

}  // namespace tubebin::jobs
