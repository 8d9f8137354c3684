// A bin that is a triangle mesh, from the configuration to a verified data set.
#include <gmock/gmock.h>

#include <filesystem>

#include "support/commands.hpp"
#include "support/faults.hpp"
#include "support/program.hpp"
#include "support/stl.hpp"
#include "tubebin/scan/scanner.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kMeshConfig =
    "set: M\nseed: 5\ntubes: [8]\ncases: 2\nscanner: {width: 480, height: 300}\n"
    "bin: {mesh: parts/box.stl, mesh_scale: 0.001}\n";

class BinMesh : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(folder_ / "parts");
    write_text(folder_ / "parts/box.stl", ascii_stl(triangles_of(scene::bin_parts(scene::Bin{})), 1000.0));
  }
  ProgramResult make(const std::string& more = "") {
    write_text(folder_ / "mesh.yaml", kMeshConfig + more);
    return run_generate_dataset({folder_ / "mesh.yaml", "--output", data_, "--jobs", "2"});
  }
  std::string verify() { return run_generate_dataset({"--verify", data_}).out; }

  TemporaryFolder folder_;
  std::string data_ = folder_ / "data";
};

TEST_F(BinMesh, ADataSetKeepsItsMeshAndIsVerifiedWithIt) {
  const ProgramResult made = make();
  ASSERT_EQ(made.exit_code, 0) << made.error;
  std::filesystem::remove_all(folder_ / "parts");
  EXPECT_THAT(verify(), HasSubstr("2 scenes checked, 0 damaged"));
  const scene::SceneRecord record = scene::read_scene_json(data_ + "/M8/001/scene.json");
  EXPECT_TRUE(std::filesystem::exists(data_ + "/" + record.scene.bin.mesh));
  expect_schema("scene.schema.json", data_ + "/M8/001/scene.json");
  write_text(data_ + "/" + record.scene.bin.mesh, ascii_stl(triangles_of(scene::bin_parts({.length = 0.6}))));
  EXPECT_THAT(run_generate_dataset({"--verify", data_}).error, HasSubstr("its content has changed"));
}

TEST_F(BinMesh, AMeshOfTheBoxIsSeenAsTheBoxIs) {
  ASSERT_EQ(make().exit_code, 0);
  for (const char* id : {"M8/001", "M8/002"}) {
    scene::Scene scene = scene::read_scene_json(data_ + "/" + id + "/scene.json").scene;
    load_mesh(scene.bin, data_);
    const cloud::Cloud mesh = scan::scan(scene).cloud;
    scene.bin = {};
    const cloud::Cloud box = scan::scan(scene).cloud;
    ASSERT_EQ(mesh.size(), box.size());
    EXPECT_EQ(mesh.labels, box.labels);
    for (std::size_t i = 0; i < box.size(); ++i) {
      ASSERT_EQ(cloud::is_finite(mesh.points[i]), cloud::is_finite(box.points[i])) << i;
      if (cloud::is_finite(box.points[i])) {
        ASSERT_LT((mesh.points[i] - box.points[i]).norm(), 1e-6F) << i;
      }
    }
  }
}

TEST_F(BinMesh, AnInnerSpaceBeyondTheMeshIsRefused) {
  write_text(folder_ / "mesh.yaml", "bin: {mesh: parts/box.stl}\n");  // millimetres taken for metres
  EXPECT_THAT(run_generate_dataset({folder_ / "mesh.yaml", "--output", data_}).error,
              HasSubstr("box.stl: line 4: -295 is not valid; valid: finite, and at most 100 m"));
  write_text(folder_ / "mesh.yaml", "bin: {mesh: parts/box.stl, mesh_scale: 0.001, height: 0.3}\n");
  EXPECT_THAT(run_generate_dataset({folder_ / "mesh.yaml", "--output", data_}).error,
              AllOf(HasSubstr("mesh.yaml:1:"), HasSubstr("bin.height: 0.3 m is not valid"),
                    HasSubstr("parts/box.stl, which reaches"), HasSubstr("0.2 m along z")));
  write_text(folder_ / "mesh.yaml", "bin: {mesh: parts/box.stl, mesh_scale: 0.001, draft_deg: 2}\n");
  EXPECT_THAT(run_generate_dataset({folder_ / "mesh.yaml", "--output", data_}).error,
              HasSubstr("parts/box.stl' is not valid beside draft_deg, rim_width or corner_radius"));
}

TEST_F(BinMesh, AnotherMeshThanTheDataSetsIsNamedAsTheUserDoes) {
  ASSERT_EQ(make().exit_code, 0);
  write_text(folder_ / "parts/box.stl", ascii_stl(triangles_of(scene::bin_parts({.length = 0.6})), 1000.0));
  EXPECT_THAT(make().error, AllOf(HasSubstr("another configuration"), HasSubstr("bin.mesh: \"" + data_ + "/bin-"),
                                  HasSubstr(".stl\" there, \"" + folder_ / "parts/box.stl\" here")));
}

TEST_F(BinMesh, APackAloneSaysThatItHasNoMesh) {
  write_text(folder_ / "mesh.yaml", kMeshConfig);
  ASSERT_EQ(run_generate_dataset({folder_ / "mesh.yaml", "--output", data_, "--pack"}).exit_code, 0);
  EXPECT_THAT(verify(), HasSubstr("2 scenes checked, 0 damaged"));
  const std::string pack = data_ + "/packs/00001-of-00001.tar";
  const ProgramResult alone =
      Program({program_path("export_dataset"), pack, "--format", "ply", "--output", folder_ / "ply"}).wait();
  EXPECT_EQ(alone.exit_code, 3);
  EXPECT_THAT(alone.error, HasSubstr("00001-of-00001.tar: a pack does not hold the mesh of its bin, bin-"));
}

TEST_F(BinMesh, TheExampleGivesScenesThatPassVerification) {
  const ProgramResult made =
      run_generate_dataset({TUBEBIN_SOURCE_DIR "/config/mesh_bin.yaml", "--output", data_, "--cases", "1"});
  ASSERT_EQ(made.exit_code, 0) << made.error;
  EXPECT_THAT(verify(), HasSubstr("1 scenes checked, 0 damaged"));
}

TEST_F(BinMesh, TheExamplesTubIsWhatItsScriptWrites) {
  const CommandResult made = run_command("python3 " TUBEBIN_SOURCE_DIR "/scripts/make_tub.py");
  ASSERT_EQ(made.exit_code, 0) << made.output;
  EXPECT_EQ(made.output, read_text(TUBEBIN_SOURCE_DIR "/config/tub.stl"));
}

}  // namespace
}  // namespace tubebin::testing
