// Memory and time follow the input's size: small inputs that ask for gigabytes, pipes and devices are refused at once.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <cmath>

#include "support/program.hpp"

namespace tubebin::testing {
namespace {

using ::testing::AnyOf;
using ::testing::Eq;
using ::testing::HasSubstr;

// The address sanitizer reserves terabytes of address space for its shadow, which any limit on it would forbid.
#ifdef __SANITIZE_ADDRESS__
constexpr const char* kLimits = "ulimit -t 60";
#else
constexpr const char* kLimits = "ulimit -v 2000000 -t 10";
#endif

class Bounds : public ::testing::Test {
 protected:
  /// A command under limits of 2 GB of memory and 10 s of a core (60 s with the address sanitizer).
  ProgramResult run(const std::string& program, const std::vector<std::string>& arguments) const {
    std::string command = fmt::format("{}; exec timeout 60 {}", kLimits, program_path(program));
    for (const std::string& argument : arguments) command += " '" + argument + "'";
    return Program({"/bin/bash", "-c", command}).wait();
  }

  void expect_bounded(const ProgramResult& result) const {
    EXPECT_THAT(result.exit_code, AnyOf(Eq(0), Eq(1), Eq(2), Eq(3))) << result.signal << result.error;
    EXPECT_EQ(result.error.find("bad_alloc"), std::string::npos);
    EXPECT_EQ(result.error.find("out of memory"), std::string::npos) << result.error;
  }
  void expect_refused(const ProgramResult& result, const std::string& file) const {
    expect_bounded(result);
    EXPECT_NE(result.exit_code, 0);
    EXPECT_THAT(result.error, HasSubstr(file));
  }

  std::string generate_small() const {
    write_text(folder_ / "c.yaml",
               "set: L\ntubes: [1]\ncases: 1\ntube: {length: 0.2}\nscanner: {width: 160, height: 100}\n");
    const ProgramResult result =
        Program({program_path("generate_dataset"), folder_ / "c.yaml", "--output", folder_ / "data", "--quiet"}).wait();
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return folder_ / "data";
  }

  TemporaryFolder folder_;
};

/// Points of which neither the area nor the extent tells how many there are.
std::string ascii_cloud(const std::vector<std::array<double, 3>>& points) {
  std::string text = fmt::format(
      "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {0}\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {0}\nDATA ascii\n",
      points.size());
  for (const auto& [x, y, z] : points) text += fmt::format("{} {} {}\n", x, y, z);
  return text;
}

TEST_F(Bounds, CloudsOfStrangeShapes) {
  std::map<std::string, std::vector<std::array<double, 3>>> clouds;
  for (int i = 0; i < 200; ++i) {
    const double t = i / 200.0;
    clouds["line"].push_back({t, 0.0, 1.0});
    clouds["long_line"].push_back({1000.0 * t, 0.0, 1.0});
    clouds["line_to_the_eye"].push_back({0.0, 0.0, t});
    clouds["dense_line"].push_back({1e-6 * t, 1e-6 * t, 1.0});
    clouds["one_place"].push_back({0.1, 0.1, 1.0});
    clouds["two_ends"].push_back({i % 2 == 0 ? 0.0 : 1e6, 0.0, 1.0});
    clouds["behind_and_before"].push_back({t, t * t, i % 2 == 0 ? 1.0 : -1.0});
    clouds["around_the_eye"].push_back({1e-3 * std::cos(t), 1e-3 * std::sin(t), 1e-9});
    clouds["huge"].push_back({1e30 * t, -1e30 * t, 1e37});
  }
  for (const auto& [name, points] : clouds)
    for (const char* method : {"centerline", "region_growing"}) {
      const std::string path = folder_ / (name + ".pcd");
      write_text(path, ascii_cloud(points));
      SCOPED_TRACE(name + " " + method);
      expect_bounded(run("model_tubes", {path, "--output", folder_ / "out", "--method", method}));
    }
}

TEST_F(Bounds, ACompressedBomb) {
  // Runs of zeros: three bytes of LZF for 264.
  constexpr std::size_t kPoints = 200'000'000;
  const std::size_t unpacked = 3 * kPoints, runs = unpacked / 264;
  std::string packed("\0\0", 2);
  for (std::size_t i = 0; i < runs; ++i) packed += std::string("\xe0\xff\0", 3);
  std::string text = fmt::format(
      "VERSION .7\nFIELDS x y z\nSIZE 1 1 1\nTYPE U U U\nCOUNT 1 1 1\nWIDTH {0}\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {0}\nDATA binary_compressed\n",
      kPoints);
  for (const std::size_t size : {packed.size(), unpacked})
    for (int byte = 0; byte < 4; ++byte) text += static_cast<char>(size >> (8 * byte));
  write_text(folder_ / "bomb.pcd", text + packed);
  const ProgramResult result = run("model_tubes", {folder_ / "bomb.pcd", "--output", folder_ / "out"});
  expect_refused(result, "bomb.pcd");
  EXPECT_THAT(result.error, HasSubstr("bytes of memory"));
}

TEST_F(Bounds, ABinaryCloudWithMorePointsThanItsHeaderSays) {
  const std::string header =
      "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA binary\n";
  write_text(folder_ / "more.pcd", header + std::string(36, '\0'));
  expect_refused(run("model_tubes", {folder_ / "more.pcd", "--output", folder_ / "out"}),
                 "2 points of 12 bytes, but there are 12 bytes more");
}

TEST_F(Bounds, DeepJson) {
  const std::string data = generate_small();
  const auto deep = [](std::size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); };
  ASSERT_EQ(run("model_tubes", {data, "--output", folder_ / "r"}).exit_code, 0);
  for (const char* format : {"coco", "bop"})
    ASSERT_EQ(run("export_dataset", {data, "--format", format, "--output", folder_ / format}).exit_code, 0);

  const std::string manifest = read_text(data + "/manifest.jsonl");
  write_text(data + "/manifest.jsonl", "{\"id\":\"L1/001\",\"rejected\":" + deep(120'000) + "}\n");
  expect_bounded(run("generate_dataset", {"--verify", data}));
  expect_bounded(run("evaluate", {folder_ / "r"}));
  write_text(data + "/manifest.jsonl", manifest);

  for (const char* file : {"index.json", "L1/001/centerline_1/result.json", "L1/001/centerline_1/model.json",
                           "L1/001/centerline_1/times.json"}) {
    const std::string path = folder_ / ("r/" + std::string(file)), good = read_text(path);
    write_text(path, "{\"a\":" + deep(65'000) + "}");
    expect_refused(run("evaluate", {folder_ / "r"}), file);
    write_text(path, good);
  }
  for (const char* format : {"coco", "bop"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_ / format)) {
      if (entry.path().extension() != ".json") continue;
      const std::string good = read_text(entry.path());
      write_text(entry.path(), deep(65'000));
      expect_bounded(run("export_dataset", {data, "--format", format, "--output", folder_ / format}));
      write_text(entry.path(), good);
    }
  }
}

TEST_F(Bounds, ConfigurationsThatAskForTooMuch) {
  std::string many = "tubes: [1";
  for (int i = 2; i <= 10'000; ++i) many += fmt::format(", {}", i);
  for (const std::string& text :
       {many + "]\ncases: 1000000\n", std::string("scanner: {width: 16384, height: 16384}\n"),
        "set: " + std::string(3 << 20, 'x') + "\n", std::string("set: A\n---\nset: B\n"),
        std::string("set: ") + std::string(100'000, '[') + "\n", std::string("scanner: {position: [0.28, 0.0, 0.1]}\n"),
        std::string("scanner: {position: [0.0, 0.0, -0.01]}\n")}) {
    write_text(folder_ / "much.yaml", text);
    const ProgramResult result = run("generate_dataset", {folder_ / "much.yaml", "--output", folder_ / "much"});
    expect_refused(result, "much.yaml");
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_FALSE(fs::exists(folder_ / "much")) << text.substr(0, 40);
  }
}

TEST_F(Bounds, PipesAndDevicesAreNotReadFrom) {
  const std::string data = generate_small();
  const std::string pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& strange : {pipe, std::string("/dev/zero")}) {
    SCOPED_TRACE(strange);
    expect_refused(run("generate_dataset", {strange, "--output", folder_ / "o"}), strange);
    write_text(folder_ / "include.yaml", "include: " + strange + "\n");
    expect_refused(run("generate_dataset", {folder_ / "include.yaml", "--output", folder_ / "o"}), "regular file");
    expect_refused(run("model_tubes", {strange, "--output", folder_ / "o"}), strange);
    expect_refused(run("model_tubes", {data, "--output", folder_ / "o", "--config", strange}), strange);
    expect_refused(run("evaluate", {"--filtered", strange, "--labeled", strange}), strange);
    for (const char* place : {"packs/1.tar", "manifest.jsonl", "config.yaml", "L1/001/scene.json"}) {
      const fs::path file = fs::path(data) / place;
      fs::create_directories(file.parent_path());
      const std::string good = fs::exists(file) ? read_text(file) : "";
      fs::remove(file);
      fs::create_symlink(strange, file);
      expect_bounded(run("generate_dataset", {"--verify", data}));
      expect_bounded(run("model_tubes", {data, "--output", folder_ / "o2"}));
      fs::remove(file);
      if (!good.empty()) write_text(file, good);
    }
  }
}

// Wherever it runs out: from where the program cannot start to where it needs no more.
TEST_F(Bounds, MemoryThatRunsOutIsSaidWithTheFile) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer ends the program where memory runs out";
#endif
  const std::string folder = TUBEBIN_SOURCE_DIR "/data/A10/003", cloud = folder + "/cloud.pcd";
  int said = 0;
  for (int kilobytes = 20'000; kilobytes < 150'000; kilobytes += 2'000) {
    const ProgramResult result = Program({"/bin/bash", "-c",
                                          fmt::format("ulimit -v {}; exec {} {} --output {}", kilobytes,
                                                      program_path("model_tubes"), cloud, folder_ / "modelled")})
                                     .wait();
    if (result.exit_code == 127) continue;  // its libraries found no room
    EXPECT_EQ(result.error.find("bad_alloc"), std::string::npos) << result.error;
    if (result.error.find("memory") == std::string::npos) continue;
    ++said;
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.error, AnyOf(HasSubstr(cloud), HasSubstr(folder + "/scene.json"))) << kilobytes;
  }
  EXPECT_GT(said, 0);
}

}  // namespace
}  // namespace tubebin::testing
