// Shards of a data set whose scenes are packed into tar files.
#include <regex>

#include "dataset/shards.hpp"
#include "tubebin/jobs/folder_lock.hpp"
#include "tubebin/scene/dataset_files.hpp"

namespace tubebin::testing {

using namespace dataset;
namespace {

using ::testing::HasSubstr;

class Packs : public Shards {
 protected:
  /// Files of all scenes, loose or packed, by the names that they have loose.
  static std::map<std::string, std::string> all_files(const std::string& dataset) {
    const scene::DatasetFiles files(dataset);
    std::map<std::string, std::string> found;
    for (const std::string& scene : files.scenes())
      for (const char* file : {"cloud.pcd", "scene.json", "tubes.txt"})
        found[scene + "/" + file] = files.read(scene, file);
    return found;
  }
};

TEST_F(Packs, HoldTheSameBytesInOneFileAPart) {
  for (const char* shard : {"1/2", "2/2"}) ASSERT_EQ(generate(data_, {"--shard", shard, "--pack"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(data_ + "/packs/00001-of-00002.tar"));
  EXPECT_FALSE(fs::exists(data_ + "/Q1"));
  EXPECT_EQ(all_files(data_), expected_);
  EXPECT_EQ(run_generate_dataset({"--verify", data_}).exit_code, 0);
  // Any order of making gives the same tar.
  ASSERT_EQ(run_generate_dataset({config_, "--output", folder_ / "again", "--jobs", "1", "--shard", "2/2", "--pack"})
                .exit_code,
            0);
  EXPECT_EQ(read_text(folder_ / "again/packs/00002-of-00002.tar"), read_text(data_ + "/packs/00002-of-00002.tar"));
  // Again: nothing is left to do.
  const std::string tar = read_text(data_ + "/packs/00001-of-00002.tar");
  EXPECT_THAT(generate(data_, {"--shard", "1/2", "--pack"}).error, HasSubstr("0 made"));
  EXPECT_EQ(read_text(data_ + "/packs/00001-of-00002.tar"), tar);
  const ProgramResult listed = Program({"/bin/tar", "--list", "--file", data_ + "/packs/00001-of-00002.tar"}).wait();
  EXPECT_EQ(listed.exit_code, 0) << listed.error;
  EXPECT_THAT(listed.out, HasSubstr(".cloud.pcd\n"));
}

TEST_F(Packs, GoOnWhereTheyWereKilled) {
  std::vector<std::string> arguments = command(data_, {"--cases", "40", "--pack"});
  arguments.insert(arguments.begin(), program_path("generate_dataset"));
  for (std::size_t goal = 10; goal < 60; goal += 10) {
    Program program(arguments);
    wait_until([&] { return !program.running() || Manifest(data_).records().size() > goal; });
    kill(program.process(), SIGKILL);
    program.wait();
    wait_until([&] { return processes_of(data_).empty(); });
  }
  ASSERT_EQ(Program(arguments).wait().exit_code, 0);
  ASSERT_EQ(generate(folder_ / "undisturbed", {"--cases", "40", "--pack"}).exit_code, 0);
  EXPECT_EQ(read_text(data_ + "/packs/00001-of-00001.tar"),
            read_text(folder_ / "undisturbed/packs/00001-of-00001.tar"));
  EXPECT_FALSE(fs::exists(data_ + "/Q1"));
}

TEST_F(Packs, ArePackedByOneRunAtATime) {
  const std::vector<std::string> shard = {"--shard", "1/2", "--pack"};
  ASSERT_EQ(generate(data_, {"--shard", "2/2", "--pack"}).exit_code, 0);
  {
    const jobs::FolderLock other(OutputFolder(data_).make_inner(kShardsFolder), jobs::Shard{.index = 1, .count = 2});
    const ProgramResult refused = generate(data_, shard);
    EXPECT_EQ(refused.exit_code, 1);  // a scheduler may start it again
    EXPECT_THAT(refused.error, HasSubstr(fmt::format("process {} is packing shard 00001-of-00002", getpid())));
  }
  EXPECT_EQ(generate(data_, shard).exit_code, 0);
  EXPECT_EQ(run_generate_dataset({"--merge", data_}).exit_code, 0);
  EXPECT_EQ(all_files(data_), expected_);
}

TEST_F(Packs, AreMergedAndCompleted) {
  ASSERT_EQ(generate(folder_ / "first", {"--shard", "1/3", "--pack"}).exit_code, 0);
  ASSERT_EQ(generate(folder_ / "third", {"--shard", "3/3", "--pack"}).exit_code, 0);
  const ProgramResult merged = run_generate_dataset({"--merge", data_, folder_ / "first", folder_ / "third"});
  EXPECT_EQ(merged.exit_code, 3) << merged.error;
  EXPECT_EQ(run_printed_command(merged.out).exit_code, 0);
  EXPECT_EQ(all_files(data_), expected_);
  const ProgramResult again = run_generate_dataset({"--merge", data_, folder_ / "first", folder_ / "third"});
  EXPECT_EQ(again.exit_code, 0) << again.out << again.error;
  EXPECT_EQ(run_generate_dataset({"--verify", data_}).exit_code, 0);
}

TEST_F(Packs, OfOneSharedFolderAreMerged) {
  for (const char* shard : {"2/3", "1/3", "3/3"}) ASSERT_EQ(generate(data_, {"--shard", shard, "--pack"}).exit_code, 0);
  const ProgramResult merged = run_generate_dataset({"--merge", data_});
  EXPECT_EQ(merged.exit_code, 0) << merged.out << merged.error;
  EXPECT_FALSE(fs::exists(data_ + "/manifest.parts"));
  EXPECT_EQ(all_files(data_), expected_);
  EXPECT_THAT(generate(data_).error, HasSubstr("8 were there before"));
  EXPECT_EQ(std::distance(fs::directory_iterator(data_ + "/packs"), {}), 3);
}

TEST_F(Packs, TheirScenesAreViewedAsLooseOnes) {
  ASSERT_EQ(generate(data_, {"--pack"}).exit_code, 0);
  const std::string scene = scene::DatasetFiles(data_).scenes().front(), html = folder_ / "view.html";
  const auto page_of = [&](const std::string& path) {
    const ProgramResult result = run_program("view", {path, "--html", html});
    EXPECT_EQ(result.exit_code, 0) << result.error;
    const std::string page = read_text(html);
    return std::regex_replace(page, std::regex(path), "PATH");
  };
  const std::string pack = data_ + "/packs/00001-of-00001.tar", loose = page_of(one_machine_ + "/" + scene);
  EXPECT_EQ(page_of(data_ + "/" + scene), loose);
  EXPECT_EQ(page_of(pack + "/" + scene), loose);

  const auto error_of = [&](const std::string& path) { return run_program("view", {path, "--html", html}).error; };
  EXPECT_THAT(error_of(data_ + "/Q1/999"), HasSubstr("the data set " + data_ + " has no scene Q1/999"));
  EXPECT_THAT(error_of(pack), HasSubstr("name one: " + pack + "/" + scene));
  EXPECT_THAT(error_of(data_ + "/"), HasSubstr("name one: " + data_ + "/" + scene));
}

TEST_F(Packs, ADamagedSceneIsFoundAndRepaired) {
  ASSERT_EQ(generate(data_, {"--pack"}).exit_code, 0);
  const std::string pack = data_ + "/packs/00001-of-00001.tar";
  std::string bytes = read_text(pack);
  const TarMember member = list_tar(pack)[3];
  bytes[member.offset + member.bytes / 2] = static_cast<char>(bytes[member.offset + member.bytes / 2] ^ 1);
  write_text(pack, bytes);
  EXPECT_THAT(run_generate_dataset({"--verify", data_}).out, HasSubstr("1 damaged"));
  EXPECT_EQ(run_generate_dataset({"--verify", data_, "--repair"}).exit_code, 0);
  EXPECT_EQ(run_generate_dataset({"--verify", data_}).exit_code, 0);
  EXPECT_EQ(all_files(data_), expected_);
}

}  // namespace
}  // namespace tubebin::testing
