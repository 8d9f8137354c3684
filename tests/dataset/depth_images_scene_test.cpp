// Data sets with depth images beside their clouds, loose and packed.
#include <fmt/ranges.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "dataset/verify_scene.hpp"
#include "support/commands.hpp"
#include "support/faults.hpp"
#include "support/grey_png.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/dataset/dataset_folder.hpp"
#include "tubebin/dataset/manifest.hpp"

namespace tubebin::testing {

using namespace dataset;
namespace {

using ::testing::HasSubstr;

class DepthImages : public ::testing::Test {
 protected:
  /// A data set of two scenes, seen obliquely by a scanner with noise; returns its folder.
  std::string make(const std::string& name, const std::string& output, const std::vector<std::string>& more = {}) {
    write_text(
        folder_ / (name + ".yaml"),
        "include: " TUBEBIN_SOURCE_DIR
        "/config/scanner_zivid_like.yaml\n"
        "set: Q\nseed: 5\ntubes: [4]\ncases: 2\n"
        "scanner: {width: 480, height: 300, horizontal_fov_deg: 35, position: [0.5, -0.7, 1.6], look_at: [0, 0, 0]}\n"
        "output: {" +
            output + "}\n");
    std::vector<std::string> arguments = {folder_ / (name + ".yaml"), "--output", folder_ / name, "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult made = run_generate_dataset(arguments);
    EXPECT_EQ(made.exit_code, 0) << made.error;
    return folder_ / name;
  }

  TemporaryFolder folder_;
};

/// Where the middle of a pixel at that depth (metres) is, by the numbers of scene.json alone.
Vec3 point_in_world(const nlohmann::json& scanner, int column, int row, double depth) {
  const auto& k = scanner["intrinsics"];
  const auto& window = scanner["window"];
  const Vec3 p_in_camera(
      (column + 0.5 + window["x"].get<int>() - k["cx"].get<double>()) / k["fx"].get<double>() * depth,
      (row + 0.5 + window["y"].get<int>() - k["cy"].get<double>()) / k["fy"].get<double>() * depth, depth);
  Vec3 p_in_world;
  for (int i = 0; i < 3; ++i) {
    p_in_world[i] = scanner["pose"]["position"][static_cast<std::size_t>(i)].get<double>();
    for (int j = 0; j < 3; ++j)
      p_in_world[i] +=
          scanner["pose"]["rotation"][static_cast<std::size_t>(i)][static_cast<std::size_t>(j)].get<double>() *
          p_in_camera[j];
  }
  return p_in_world;
}

TEST_F(DepthImages, ShowEveryPointOfTheCloudInItsPixel) {
  const std::string scene = make("images", "depth_image: true") + "/Q4/001/";
  const cloud::Cloud cloud = cloud::read_cloud(scene + "cloud.pcd");
  const auto json = nlohmann::json::parse(read_text(scene + "scene.json"));
  const GreyImage depth = read_grey_png(read_text(scene + "depth.png")),
                  labels = read_grey_png(read_text(scene + "labels.png"));
  const double metres_per_unit = json["depth_image"]["mm_per_unit"].get<double>() / 1000.0;
  EXPECT_EQ(metres_per_unit, 1e-4);
  ASSERT_EQ(depth.width, static_cast<int>(cloud.width));
  ASSERT_EQ(depth.values.size(), cloud.size());
  ASSERT_EQ(labels.values.size(), cloud.size());
  // Half a unit of depth moves a point along its ray, which is up to 20 degrees off the axis.
  double largest = 0.0;
  std::size_t seen = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_EQ(depth.values[i] > 0, cloud::is_finite(cloud.points[i])) << i;
    EXPECT_EQ(labels.values[i], cloud.labels[i]) << i;
    if (depth.values[i] == 0) continue;
    ++seen;
    const int column = static_cast<int>(i) % depth.width, row = static_cast<int>(i) / depth.width;
    const Vec3 point = point_in_world(json["scanner"], column, row, depth.values[i] * metres_per_unit);
    largest = std::max(largest, (point - cloud.points[i].cast<double>()).norm());
  }
  EXPECT_GT(seen, cloud.size() / 2);
  EXPECT_LT(largest, 0.56e-4);
  expect_schema("scene.schema.json", scene + "scene.json");
}

TEST_F(DepthImages, ChangeNoByteOfTheOtherFiles) {
  const auto without = scene_files(make("without", "clean_cloud: false")),
             with = scene_files(make("with", "clean_cloud: false, depth_image: true"));
  EXPECT_EQ(with.size(), without.size() + 4);
  for (const auto& [name, bytes] : without) {
    if (name.ends_with("scene.json")) {
      auto json = nlohmann::ordered_json::parse(with.at(name));
      EXPECT_EQ(json.erase("depth_image"), 1U);
      EXPECT_EQ(json, nlohmann::ordered_json::parse(bytes));
    } else {
      EXPECT_EQ(with.at(name), bytes) << name;
    }
  }
}

TEST_F(DepthImages, AreTheSameWhateverTheCloudsFrameAndUnit) {
  const auto world = scene_files(make("world", "depth_image: true"));
  const std::string data = make("camera", "depth_image: true, frame: camera, unit: mm");
  const auto camera = scene_files(data);
  for (const char* file : {"Q4/001/depth.png", "Q4/002/labels.png"}) EXPECT_EQ(camera.at(file), world.at(file));
  const ProgramResult verified = run_generate_dataset({"--verify", data});
  EXPECT_EQ(verified.exit_code, 0) << verified.out;
}

TEST_F(DepthImages, ArePackedVerifiedAndRepaired) {
  const auto expected = scene_files(make("loose", "depth_image: true"));
  const std::string data = make("packed", "depth_image: true", {"--pack"}), pack = data + "/packs/00001-of-00001.tar";
  const std::string sound = read_text(pack);
  std::map<std::string, TarMember> members;
  for (const TarMember& member : list_tar(pack)) members[member.name] = member;
  for (const char* file : {"depth.png", "labels.png"})
    EXPECT_EQ(read_tar_member(pack, members.at(std::string("Q4/002.") + file)),
              expected.at(std::string("Q4/002/") + file));

  std::string bytes = sound;
  const TarMember& depth = members.at("Q4/002.depth.png");
  bytes[depth.offset + depth.bytes / 2] = static_cast<char>(bytes[depth.offset + depth.bytes / 2] ^ 1);
  write_text(pack, bytes);
  EXPECT_THAT(run_generate_dataset({"--verify", data}).out, HasSubstr("Q4/002: depth.png has hash"));
  EXPECT_EQ(run_generate_dataset({"--verify", data, "--repair"}).exit_code, 0);
  EXPECT_EQ(run_generate_dataset({"--verify", data}).exit_code, 0);
  const scene::DatasetFiles repaired(data);
  EXPECT_EQ(repaired.read("Q4/002", "depth.png"), expected.at("Q4/002/depth.png"));
}

TEST_F(DepthImages, AreVerifiedPixelByPixel) {
  const std::string data = make("data", "depth_image: true");
  const auto problems_with = [&](const std::string& file, const std::string& bytes) {
    ManifestRecord record = *Manifest(data).find("Q4/001");
    const std::string path = data + "/Q4/001/" + file, sound = read_text(path);
    write_text(path, bytes);
    record.files[file] = record_bytes(bytes);
    const auto problems = verify_scene(scene::DatasetFiles(data), read_dataset_config(data), {"Q", 4, 1}, record);
    write_text(path, sound);
    return fmt::format("{}", fmt::join(problems, "\n"));
  };
  for (const char* file : {"depth.png", "labels.png"}) {
    GreyImage image = read_grey_png(read_text(data + "/Q4/001/" + file));
    EXPECT_EQ(problems_with(file, write_grey_png(image)), "");
    image.values[image.values.size() / 2] = static_cast<std::uint16_t>(image.values[image.values.size() / 2] + 2);
    EXPECT_THAT(problems_with(file, write_grey_png(image)),
                HasSubstr("1 pixels of depth.png or labels.png are not those"));
    image.values.resize(image.values.size() - static_cast<std::size_t>(image.width));
    --image.height;
    EXPECT_THAT(problems_with(file, write_grey_png(image)), HasSubstr("with 16 bits of grey each"));
  }
  scene::SceneRecord record = scene::read_scene_json(data + "/Q4/001/scene.json");
  record.depth_mm_per_unit = 1.0;
  EXPECT_THAT(problems_with("scene.json", scene::format_scene_json(record)), HasSubstr("1 mm a unit of depth.png"));
  record.depth_mm_per_unit.reset();
  EXPECT_THAT(problems_with("scene.json", scene::format_scene_json(record)),
              HasSubstr("scene.json has a depth image where"));
}

}  // namespace
}  // namespace tubebin::testing
