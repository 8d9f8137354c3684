// Faults that are really made: kills and full disks.
#pragma once

#include <sys/mount.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include "support/program.hpp"

namespace tubebin::testing {

using namespace std::chrono_literals;

/// Processes whose command line names the folder.
inline std::vector<pid_t> processes_of(const std::string& folder) {
  std::vector<pid_t> found;
  for (const fs::directory_entry& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    if (read_text(entry.path() / "cmdline").find(folder) != std::string::npos) found.push_back(std::stoi(name));
  }
  return found;
}

/// Waits for something that must come; the test's own time limit ends a wait that is in vain.
template <typename Condition>
void wait_until(Condition condition) {
  while (!condition()) std::this_thread::sleep_for(1ms);
}

/// What Ctrl-C made of a program whose workers hang.
struct Stop {
  ProgramResult result;
  double seconds = 0.0;  ///< from the signal to the program's end
};

/// Workers that hang are the slowest to stop: they use up all the time that the program gives them.
inline Stop stop_hanging(Program& program, const std::string& folder) {
  for (const pid_t process : processes_of(folder))
    if (process != program.process()) kill(process, SIGSTOP);
  const auto start = std::chrono::steady_clock::now();
  kill(-program.process(), SIGINT);
  Stop stop{.result = program.wait()};
  stop.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return stop;
}

/// What users are promised. Other load may delay a program beyond that, but not each of so many tries.
constexpr double kStopSecondsMax = 2.0;
constexpr int kStopTries = 5;

/// A file system of four megabytes, where the test may mount one.
class SmallDisk {
 public:
  SmallDisk() {
    fs::create_directory(path_);
    mounted_ = mount("tmpfs", path_.c_str(), "tmpfs", 0, kOptions) == 0;
    error_ = errno;
  }
  ~SmallDisk() {
    if (mounted_) umount2(path_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  bool mounted() const { return mounted_; }
  std::string why_not() const {
    return std::string("cannot mount a small tmpfs (needs root): ") + std::strerror(error_);
  }
  const std::string& path() const { return path_; }
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }

  /// Fills it up but for so many bytes.
  void leave_free(std::uintmax_t bytes) const {
    leave_all_free();
    const std::uintmax_t available = fs::space(path_).available;
    write_text(path_ + "/filler", std::string(available > bytes ? available - bytes : 0, 'x'));
  }
  void leave_all_free() const { fs::remove(path_ + "/filler"); }

  void make_read_only() const {
    ASSERT_EQ(mount("tmpfs", path_.c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, kOptions), 0) << std::strerror(errno);
  }

 private:
  static constexpr const char* kOptions = "size=4m";
  TemporaryFolder folder_;
  std::string path_ = folder_ / "disk";
  bool mounted_ = false;
  int error_ = 0;
};

}  // namespace tubebin::testing
