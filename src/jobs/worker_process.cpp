#include "jobs/worker_process.hpp"

#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <new>
#include <stdexcept>
#include <thread>
#include <utility>

#include "tubebin/core/error.hpp"
#include "tubebin/core/memory.hpp"

namespace tubebin::jobs {
namespace {

// Longest text of a message, which must fit into the socket's buffer.
constexpr std::size_t kLongestText = 48 * 1024;
// In the place of the kind: a part of a result, of which more follows.
constexpr char kPart = 'p';
// Divides a failure's reason from its detail.
constexpr char kDivider = '\n';

/// A message is the kind of the answer, one byte, then its text.
void send_message(int socket, char kind, const std::string& text) {
  const std::string message = kind + text;
  while (send(socket, message.data(), message.size(), MSG_NOSIGNAL) < 0)
    if (errno != EINTR) _exit(1);  // the parent is gone
}

/// A failure's text may lose its end, a result may not.
void send_answer(int socket, WorkerAnswer::Kind kind, std::string text) {
  for (; kind == WorkerAnswer::Kind::succeeded && text.size() > kLongestText; text.erase(0, kLongestText))
    send_message(socket, kPart, text.substr(0, kLongestText));
  send_message(socket, static_cast<char>(kind), text.substr(0, kLongestText));
}

/// Attempts one by one; the end of each that succeeded beside the next one.
class Server {
 public:
  Server(int socket, const Work& work) : socket_(socket), work_(work) {}

  [[noreturn]] void serve() {
    Attempt attempt;
    while (true) {
      const ssize_t size = recv(socket_, &attempt, sizeof(attempt), 0);
      if (size < 0 && errno == EINTR) continue;
      if (size != sizeof(attempt)) _exit(0);  // the parent has no more work or is gone
      make_attempt(attempt);
    }
  }

 private:
  void make_attempt(const Attempt& attempt) {
    try {
      AttemptResult result = work_(attempt.job, attempt.number);
      if (!result.succeeded)
        return send_answer(socket_, WorkerAnswer::Kind::failed, result.text + kDivider + result.detail);
      if (finishing_.joinable()) finishing_.join();
      send_answer(socket_, WorkerAnswer::Kind::computed, "");
      finishing_ = std::thread([this, result = std::move(result)] { finish(result); });
    } catch (const IoError& error) {
      send_answer(socket_, WorkerAnswer::Kind::io_error, error.what());
    } catch (const ConfigError& error) {
      send_answer(socket_, WorkerAnswer::Kind::config_error, error.what());
    } catch (const std::bad_alloc&) {
      send_answer(socket_, WorkerAnswer::Kind::failed, std::string("crash") + kDivider + "out of memory");
    } catch (const std::exception& error) {
      send_answer(socket_, WorkerAnswer::Kind::failed, std::string("crash") + kDivider + error.what());
    }
  }

  void finish(const AttemptResult& result) const {
    try {
      send_answer(socket_, WorkerAnswer::Kind::succeeded, result.finish ? result.finish() : result.text);
    } catch (const std::exception& error) {
      send_answer(socket_, WorkerAnswer::Kind::io_error, error.what());
    }
  }

  int socket_;
  const Work& work_;
  std::thread finishing_;
};

/// Ctrl-C reaches every process of a terminal: workers leave the answer to it to their parent.
void set_signals_of_worker() {
  signal(SIGINT, SIG_IGN);
  signal(SIGHUP, SIG_IGN);
  signal(SIGTERM, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

}  // namespace

WorkerProcess::WorkerProcess(const Work& work, const std::vector<int>& others) {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw_io_error("cannot make a socket for a worker process: {}", std::strerror(errno));
  socket_ = FileDescriptor(ends[0]);
  FileDescriptor worker_end(ends[1]);
  const pid_t parent = getpid();
  process_ = fork();
  if (process_ < 0) throw_io_error("cannot start a worker process: {}", std::strerror(errno));
  if (process_ > 0) return;

  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // it died before the line above
  set_signals_of_worker();
  close(ends[0]);
  for (const int other : others) close(other);
  keep_memory();
  Server(ends[1], work).serve();
}

WorkerProcess::~WorkerProcess() {
  kill();
  wait();
}

bool WorkerProcess::start(const Attempt& attempt) {
  while (true) {
    const ssize_t size = send(socket_.get(), &attempt, sizeof(attempt), MSG_NOSIGNAL);
    if (size == sizeof(attempt)) return true;
    if (size < 0 && errno != EINTR) return false;
  }
}

WorkerAnswer WorkerProcess::answer() {
  std::vector<char> buffer(kLongestText + 1);
  while (true) {
    const ssize_t size = recv(socket_.get(), buffer.data(), buffer.size(), 0);
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return {};
    const std::string text(buffer.data() + 1, static_cast<std::size_t>(size) - 1);
    if (buffer[0] == kPart) {
      begun_result_ += text;
      continue;
    }
    const auto kind = static_cast<WorkerAnswer::Kind>(buffer[0]);
    if (kind == WorkerAnswer::Kind::succeeded) return {kind, std::exchange(begun_result_, {}) + text, ""};
    if (kind != WorkerAnswer::Kind::failed) return {kind, text, ""};
    const std::size_t divider = std::min(text.find(kDivider), text.size());
    return {kind, text.substr(0, divider), text.substr(std::min(divider + 1, text.size()))};
  }
}

void WorkerProcess::kill() {
  if (!end_signal_) ::kill(process_, SIGKILL);
}

int WorkerProcess::wait() {
  if (end_signal_) return *end_signal_;
  int status = 0;
  while (waitpid(process_, &status, 0) < 0 && errno == EINTR) continue;
  end_signal_ = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  return *end_signal_;
}

}  // namespace tubebin::jobs
