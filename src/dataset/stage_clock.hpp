/// How long each stage of making a scene takes.
#pragma once

#include <chrono>
#include <map>
#include <string>

namespace tubebin::dataset {

/// Adds the time since the last call to the named stage.
class StageClock {
 public:
  explicit StageClock(std::map<std::string, double>& seconds) : seconds_(seconds) {}
  void end_stage(const char* name) {
    const auto now = std::chrono::steady_clock::now();
    seconds_[name] += std::chrono::duration<double>(now - start_).count();
    start_ = now;
  }

 private:
  std::map<std::string, double>& seconds_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace tubebin::dataset
