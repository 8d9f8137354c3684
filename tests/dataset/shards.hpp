/// Data sets made in shards, beside those of one machine.
#pragma once

#include <gmock/gmock.h>

#include "support/faults.hpp"
#include "tubebin/dataset/manifest.hpp"

namespace tubebin::testing {

using namespace dataset;

inline ProgramResult run_program(const std::string& name, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), program_path(name));
  return Program(arguments).wait();
}

/// What the command printed after "To make exactly what is missing:", with our program for the one on the PATH.
inline ProgramResult run_printed_command(const std::string& out) {
  const std::string mark = "To make exactly what is missing:\n  ";
  const std::size_t begin = out.find(mark);
  if (begin == std::string::npos) return {};
  const std::string command =
      out.substr(begin + mark.size(), out.find('\n', begin + mark.size()) - begin - mark.size());
  return Program({"/bin/sh", "-c", "PATH=" TUBEBIN_BIN_DIR ":$PATH; exec " + command}).wait();
}

class Shards : public ::testing::Test {
 protected:
  Shards() {
    write_text(config_, quick_config());
    EXPECT_EQ(generate(one_machine_).exit_code, 0);
    expected_ = scene_files(one_machine_);
  }

  std::vector<std::string> command(const std::string& output, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {config_, "--output", output, "--jobs", "2"});
    return more;
  }
  ProgramResult generate(const std::string& output, std::vector<std::string> more = {}) const {
    return run_generate_dataset(command(output, std::move(more)));
  }

  void expect_as_of_one_machine(const std::string& data) const {
    EXPECT_EQ(scene_files(data), expected_);
    EXPECT_EQ(read_text(data + "/config.yaml"), read_text(one_machine_ + "/config.yaml"));
    EXPECT_FALSE(fs::exists(data + "/manifest.parts"));
    const Manifest manifest(data), other(one_machine_);
    ASSERT_EQ(manifest.records().size(), other.records().size());
    for (const auto& [id, record] : manifest.records()) {
      EXPECT_EQ(record.files, other.find(id)->files);
      EXPECT_EQ(record.seed, other.find(id)->seed);
    }
    EXPECT_EQ(run_generate_dataset({"--verify", data}).exit_code, 0);
  }

  TemporaryFolder folder_;
  std::string config_ = folder_ / "quick.yaml";
  std::string one_machine_ = folder_ / "one";
  std::string data_ = folder_ / "shared data";  // with a space, for the commands that are printed
  std::map<std::string, std::string> expected_;
};

}  // namespace tubebin::testing
