// Data sets and packs as somebody may have made them to do harm: nothing outside the output folder is written, replaced or
// removed, whatever they say.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "support/program.hpp"
#include "tubebin/core/file_record.hpp"
#include "tubebin/core/tar.hpp"

namespace tubebin::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

ProgramResult run_program(const std::string& name, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), program_path(name));
  return Program(arguments).wait();
}

/// Everything in a folder: kind, and a link's target or a file's bytes, by path.
std::map<std::string, std::string> snapshot(const std::string& folder) {
  std::map<std::string, std::string> found;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    found[entry.path().string()] = entry.is_symlink()     ? "link " + fs::read_symlink(entry.path()).string()
                                   : entry.is_directory() ? "folder"
                                                          : read_text(entry.path());
  return found;
}

class UntrustedDataset : public ::testing::Test {
 protected:
  UntrustedDataset() {
    fs::create_directories(victim_ + "/L1/001");
    write_text(victim_ + "/L1/001/photo.jpg", "photo");
    write_text(victim_ + "/file", "precious");
    write_text(folder_ / "c.yaml",
               "set: L\nseed: 7\ntubes: [1]\ncases: 2\ntube: {length: 0.2, cylinder_count_max: 6}\n"
               "scanner: {width: 160, height: 100}\n");
    fs::create_directories(folder_ / "in");
    before_ = snapshot(victim_);
  }

  void generate(const std::string& output, std::vector<std::string> options = {}) const {
    options.insert(options.begin(), {folder_ / "c.yaml", "--output", output, "--quiet"});
    ASSERT_EQ(run_generate_dataset(options).exit_code, 0);
  }

  /// Replaces every such text in the file.
  static void replace(const std::string& file, const std::string& from, const std::string& to) {
    std::string text = read_text(file);
    std::size_t count = 0;
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()), ++count)
      text.replace(at, from.size(), to);
    ASSERT_GT(count, 0u) << from << " in " << file;
    write_text(file, text);
  }

  void expect_refused(const ProgramResult& result) const {
    EXPECT_TRUE(result.exit_code == 1 || result.exit_code == 2 || result.exit_code == 3)
        << result.exit_code << " signal " << result.signal << "\n"
        << result.out << result.error;
    EXPECT_EQ(snapshot(victim_), before_);
    EXPECT_FALSE(fs::exists(folder_ / "x.sh"));
    EXPECT_FALSE(fs::exists(folder_ / "outside"));
  }

  ProgramResult merge() const {
    return run_generate_dataset({"--merge", folder_ / "out", folder_ / "in/shard", "--quiet", "--jobs", "1"});
  }

  TemporaryFolder folder_;
  std::string victim_ = folder_ / "victim";
  std::map<std::string, std::string> before_;
};

TEST_F(UntrustedDataset, FileNamesOfAManifestStayInTheScene) {
  generate(folder_ / "in/shard");
  const std::string good = read_text(folder_ / "in/shard/manifest.jsonl");
  for (const std::string& name : {std::string("../../../x.sh"), std::string("../x.sh"), folder_ / "x.sh",
                                  std::string("a/../../../../x.sh"), std::string(".."), std::string("sub/x.sh")}) {
    // The name leads to bytes that agree with the record, from the shard's folder as from the output's.
    for (const char* at : {"x.sh", "in/shard/x.sh"}) write_text(folder_ / at, "payload");
    std::string text;
    std::istringstream lines(good);
    for (std::string line; std::getline(lines, line); text += line + '\n') {
      json record = json::parse(line);
      record["files"][name] = {{"bytes", 7}, {"xxh128", record_bytes("payload").xxh128}};
      line = record.dump();
    }
    write_text(folder_ / "in/shard/manifest.jsonl", text);
    fs::remove(folder_ / "x.sh");
    const ProgramResult result = merge();
    expect_refused(result);
    fs::remove_all(folder_ / "out");
  }
}

TEST_F(UntrustedDataset, ASetsNameStaysInTheOutput) {
  for (const std::string& set : {std::string("../victim/L"), victim_ + "/L", std::string("a/../../victim/L")}) {
    generate(folder_ / "in/shard");
    replace(folder_ / "in/shard/config.yaml", "set: \"L\"", "set: \"" + set + "\"");
    replace(folder_ / "in/shard/manifest.jsonl", "\"id\":\"L1", "\"id\":\"" + set + "1");
    fs::create_directories(folder_ / "in/victim");
    fs::copy(folder_ / "in/shard/L1", folder_ / "in/victim/L1", fs::copy_options::recursive);
    expect_refused(merge());
    for (const char* option : {"--verify", "--merge"})
      expect_refused(run_generate_dataset({option, folder_ / "in/shard", "--quiet"}));
    fs::remove_all(folder_ / "in");
    fs::remove_all(folder_ / "out");
  }
}

TEST_F(UntrustedDataset, APacksNameStaysAmongThePacks) {
  for (const std::string& name :
       {std::string("../../victim/file"), victim_ + "/file", std::string("../manifest.jsonl")}) {
    generate(folder_ / "in/shard", {"--pack"});
    fs::create_directories(folder_ / "in/victim");
    fs::copy_file(folder_ / "in/shard/packs/00001-of-00001.tar", folder_ / "in/victim/file");
    replace(folder_ / "in/shard/manifest.jsonl", "\"file\":\"00001-of-00001.tar\"", "\"file\":\"" + name + "\"");
    expect_refused(merge());
    fs::remove_all(folder_ / "in");
    fs::remove_all(folder_ / "out");
  }
}

TEST_F(UntrustedDataset, MembersOfATarStayInTheDataSet) {
  generate(folder_ / "good");
  for (const std::string& start :
       {std::string("../../outside/"), folder_ / "outside/", std::string("L1/../../../outside/")}) {
    std::string tar;
    for (const char* file : {"cloud.pcd", "scene.json", "tubes.txt"})
      tar += format_tar_member(start + "L1/001." + file, read_text(folder_ / "good/L1/001" + std::string("/") + file));
    fs::create_directories(folder_ / "ds/packs");
    write_text(folder_ / "ds/packs/00001-of-00001.tar", tar + format_tar_end());
    expect_refused(run_program("model_tubes", {folder_ / "ds", "--output", folder_ / "w/results", "--quiet"}));
    for (const char* format : {"npz", "ply", "sdf", "coco", "bop"})
      expect_refused(run_program("export_dataset", {folder_ / "ds", "--format", format, "--output",
                                                    folder_ / "w/" + std::string(format), "--quiet"}));
  }
}

TEST_F(UntrustedDataset, ScenesOfAnIndexStayInTheResults) {
  generate(folder_ / "good");
  const std::string results = folder_ / "results";
  ASSERT_EQ(run_program("model_tubes", {folder_ / "good", "--output", results, "--quiet"}).exit_code, 0);
  replace(results + "/index.json", "\"L1/001\"", "\"../victim/L1/001\"");
  expect_refused(run_program("evaluate", {results, "--quiet"}));
  expect_refused(run_program("model_tubes", {"--resume", results, "--quiet"}));
}

TEST_F(UntrustedDataset, LinksInAnOutputAreNotFollowed) {
  struct Case {
    const char* link;
    bool to_folder;
    std::vector<std::string> options;
  };
  for (const Case& c :
       {Case{".lock", false, {}}, Case{"manifest.jsonl", false, {}}, Case{"L1", true, {}}, Case{"L1", true, {"--pack"}},
        Case{"packs", true, {"--pack"}}, Case{"packs/00001-of-00001.tar", false, {"--pack"}},
        Case{"manifest.parts", true, {"--shard", "1/1"}},
        Case{"manifest.parts/00001-of-00001.lock", false, {"--shard", "1/1", "--pack"}}}) {
    const std::string output = folder_ / "linked";
    generate(output, c.options);
    const std::string link = output + "/" + c.link;
    fs::remove_all(link);
    fs::create_directories(fs::path(link).parent_path());
    if (c.to_folder) fs::create_directory_symlink(victim_, link);
    else fs::create_symlink(victim_ + "/file", link);
    std::vector<std::string> again = {folder_ / "c.yaml", "--output", output, "--quiet", "--cases", "3"};
    again.insert(again.end(), c.options.begin(), c.options.end());
    run_generate_dataset(again);
    run_generate_dataset({"--merge", output, "--quiet"});
    run_generate_dataset({"--verify", output, "--repair", "--quiet"});
    EXPECT_EQ(snapshot(victim_), before_) << c.link;
    fs::remove_all(output);
  }
}

TEST_F(UntrustedDataset, LinksInResultsAndExportsAreNotFollowed) {
  generate(folder_ / "good");
  for (const bool exports : {false, true})
    for (const char* name : {"L1", ".lock", "index.json"}) {
      const std::string output = folder_ / "linked";
      fs::create_directories(output);
      const std::string link = output + "/" + name;
      if (std::string(name) == "L1") fs::create_directory_symlink(victim_, link);
      else fs::create_symlink(victim_ + "/file", link);
      if (exports) run_program("export_dataset", {folder_ / "good", "--format", "ply", "--output", output, "--quiet"});
      else run_program("model_tubes", {folder_ / "good", "--output", output, "--quiet"});
      EXPECT_EQ(snapshot(victim_), before_) << name;
      fs::remove_all(output);
    }
}

TEST_F(UntrustedDataset, MergingLeavesThePartsPackAsItIs) {
  generate(folder_ / "in/shard", {"--pack"});
  const std::string pack = folder_ / "in/shard/packs/00001-of-00001.tar", bytes = read_text(pack);
  ASSERT_EQ(merge().exit_code, 0);
  std::vector<std::string> more = {folder_ / "c.yaml", "--output", folder_ / "out", "--pack",
                                   "--cases",          "4",        "--quiet"};
  ASSERT_EQ(run_generate_dataset(more).exit_code, 0);
  EXPECT_EQ(read_text(pack), bytes);
  EXPECT_GT(read_text(folder_ / "out/packs/00001-of-00001.tar").size(), bytes.size());
}

TEST_F(UntrustedDataset, MergingSaysWhatItCouldNotCheck) {
  generate(folder_ / "in/shard");
  fs::remove(folder_ / "in/shard/L1/002/cloud.pcd");
  fs::create_directory(folder_ / "in/shard/L1/002/cloud.pcd");  // there, and nobody can read it
  const ProgramResult result = merge();
  EXPECT_EQ(result.exit_code, 3) << result.out << result.error;
  EXPECT_THAT(result.out, HasSubstr("L1/002/cloud.pcd: cannot be read"));
  EXPECT_THAT(result.out, HasSubstr("1 of 2 scenes are complete and sound"));
}

TEST_F(UntrustedDataset, AnotherVersionsDataSetIsNotVouchedFor) {
  generate(folder_ / "in/shard");
  replace(folder_ / "in/shard/config.yaml", "tool_version: \"0.", "tool_version: \"9.");
  for (const ProgramResult& result : {merge(), run_generate_dataset({"--verify", folder_ / "in/shard"}),
                                      run_generate_dataset({"--merge", folder_ / "in/shard"})}) {
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.error, HasSubstr("tool_version"));
  }
}

}  // namespace
}  // namespace tubebin::testing
