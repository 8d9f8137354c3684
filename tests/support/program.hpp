// Runs the built programs as a user would, and looks at the folders that they leave.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

extern char** environ;

namespace tubebin::testing {

namespace fs = std::filesystem;

inline std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Into a folder that is made if it is not there.
inline void write_text(const fs::path& path, const std::string& text) {
  if (path.has_parent_path()) fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

/// A new folder that is gone at the end of the scope.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "tubebin_test_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("mkdtemp failed");
    path_ = name;
  }
  ~TemporaryFolder() { fs::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

struct ProgramResult {
  int exit_code = -1;  ///< -1: ended by `signal`
  int signal = 0;
  std::string out;
  std::string error;
};

/// A program that runs, in a process group of its own.
class Program {
 public:
  explicit Program(std::vector<std::string> arguments) {
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    const int flags = O_WRONLY | O_CREAT | O_TRUNC;
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, (folder_ / "out").c_str(), flags, 0666);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, (folder_ / "error").c_str(), flags, 0666);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    const int error = posix_spawn(&process_, argv[0], &files, &attributes, argv.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    if (error != 0) throw std::runtime_error("cannot run " + arguments[0]);
  }

  pid_t process() const { return process_; }
  bool running() const {
    return waitid(P_PID, static_cast<id_t>(process_), &info_, WEXITED | WNOHANG | WNOWAIT) == 0 && info_.si_pid == 0;
  }

  ProgramResult wait() {
    int status = 0;
    waitpid(process_, &status, 0);
    return {.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1,
            .signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0,
            .out = read_text(folder_ / "out"),
            .error = read_text(folder_ / "error")};
  }

 private:
  TemporaryFolder folder_;
  pid_t process_ = -1;
  mutable siginfo_t info_{};
};

inline std::string program_path(const std::string& name) { return TUBEBIN_BIN_DIR "/" + name; }

inline ProgramResult run_generate_dataset(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), program_path("generate_dataset"));
  return Program(arguments).wait();
}

/// Name and bytes of every file of a data set's scenes.
inline std::map<std::string, std::string> scene_files(const std::string& dataset) {
  std::map<std::string, std::string> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(dataset)) {
    const fs::path name = fs::relative(entry.path(), dataset);
    if (name.begin()->string() == "manifest.parts") continue;
    if (entry.is_regular_file() && name.has_parent_path()) files[name.string()] = read_text(entry.path());
  }
  return files;
}

/// Quick to make: few, short tubes and a coarse scanner.
inline std::string quick_config() {
  return "set: Q\nseed: 5\ntubes: [1, 3]\ncases: 4\n"
         "tube: {length: 0.2, cylinder_count_max: 6}\n"
         "scanner: {width: 320, height: 200}\n";
}

}  // namespace tubebin::testing
