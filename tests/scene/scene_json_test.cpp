#include "tubebin/scene/scene_json.hpp"

#include <gmock/gmock.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "tubebin/cloud/label_colors.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/random.hpp"
#include "tubebin/tube/tube_generator.hpp"

namespace tubebin::scene {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::StartsWith;

SceneRecord make_record(int tube_count) {
  Random random(21);
  SceneRecord record;
  record.id = "A10/007";
  record.seed = std::numeric_limits<std::uint64_t>::max() - 5;
  record.scene.bin.height = 0.1 + 0.2;
  record.scene.scanner.rotation_deg = {10.0, -5.0, 33.3};
  record.scene.scanner.region = ScanRegion::full;
  record.window = {700, 400, 500, 333};
  for (tube::Tube& tube : tube::generate_tubes(tube_count, tube::TubeOptions{}, random)) {
    const Vec3 place(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), 0.05);
    record.scene.tubes.push_back({std::move(tube), make_pose(random.rotation(), place)});
    record.tube_pixels.push_back(record.tube_pixels.size() * 1000);
  }
  record.colors = cloud::label_colors(static_cast<std::size_t>(tube_count));
  if (tube_count > 1)
    record.contacts = {{0, 1, {0.1, 0.2, 0.0}, {0, 0, 1}, 1e-4}, {1, 2, {0, 0, 0.025}, {0, 0, 1}, -1e-5}};
  record.relations.emplace().amodal_pixels.assign(record.tube_pixels.size(), 12345);
  if (tube_count > 1) {
    record.relations->occlusions = {{0, 1, 17}, {2, 1, 300}};
    record.relations->above = {{1, 2}, {2, 1}};
  }
  return record;
}

SceneRecord parse(const std::string& text) { return parse_scene_json(text, "scene.json"); }

std::vector<KeyValue> list_effects(ScannerEffects effects) {
  return list_fields([&](Fields& fields) { describe(fields, effects); });
}

TEST(SceneJson, ScannerEffectsAreThereWhereAnyIsOn) {
  SceneRecord record = make_record(2);
  const json without = json::parse(format_scene_json(record));
  EXPECT_FALSE(without["scanner"].contains("effects"));
  record.scene.scanner.effects.range_noise.correlation_length = 3.0;  // of a noise that is off
  EXPECT_EQ(json::parse(format_scene_json(record)), without);

  ScannerEffects& effects = record.scene.scanner.effects;
  effects.range_noise.sigma = 1e-3 / 3.0;
  effects.projector = {.enabled = true, .position = {0.3, -0.01, 0.02}};
  effects.calibration.focal = -0.001;
  const std::string text = format_scene_json(record);
  EXPECT_EQ(list_effects(parse(text).scene.scanner.effects), list_effects(effects));

  const json schema = json::parse(read_file(TUBEBIN_SOURCE_DIR "/docs/scene.schema.json"));
  const std::function<void(const json&, const json&)> same_keys = [&](const json& object, const json& described) {
    for (const auto& [key, value] : object.items()) {
      ASSERT_TRUE(described["properties"].contains(key)) << key;
      if (value.is_object()) same_keys(value, described["properties"][key]);
    }
    EXPECT_EQ(described["properties"].size(), object.size());
    EXPECT_EQ(described["required"].size(), object.size());
  };
  same_keys(json::parse(text)["scanner"]["effects"], schema["properties"]["scanner"]["properties"]["effects"]);

  json broken = json::parse(text);
  broken["scanner"]["effects"]["outliers"]["share"] = 1.5;
  EXPECT_THAT([&] { parse(broken.dump()); },
              ::testing::ThrowsMessage<IoError>(HasSubstr("/scanner/effects/outliers/share")));
}

TEST(SceneJson, ABinThatIsNoBoxSaysSo) {
  SceneRecord record = make_record(1);
  EXPECT_FALSE(json::parse(format_scene_json(record))["bin"].contains("draft_deg"));
  record.scene.bin.draft_deg = 2.0 / 3.0;
  record.scene.bin.corner_radius = 0.03;
  const json written = json::parse(format_scene_json(record));
  EXPECT_EQ(parse(written.dump()).scene.bin, record.scene.bin);
  const json schema = json::parse(read_file(TUBEBIN_SOURCE_DIR "/docs/scene.schema.json"));
  for (const auto& [key, value] : written["bin"].items())
    EXPECT_TRUE(schema["properties"]["bin"]["properties"].contains(key)) << key;

  json broken = written;
  broken["bin"]["corner_radius"] = 0.2;
  EXPECT_THAT([&] { parse(broken.dump()); }, ::testing::ThrowsMessage<IoError>(HasSubstr("/bin/corner_radius")));
}

Surroundings make_surroundings() {
  return {.table = {.position = {0.0, 0.0, -0.05}, .size = {1.6, 1.2, 0.03}},
          .boxes = {{.position = {0.1 + 0.2, 0.5, -0.02}, .yaw_deg = 100.0 / 3.0, .size = {0.1, 0.2, 1.0 / 3.0}}},
          .cylinders = {{.position = {-0.6, 0.0, -0.02}, .radius = 0.04, .height = 0.1}},
          .bins = {{.position = {0.0, -0.5, 0.0}, .yaw_deg = 200.0 / 3.0}}};
}

TEST(SceneJson, WhatStandsAroundReadsBack) {
  SceneRecord record = make_record(1);
  EXPECT_FALSE(json::parse(format_scene_json(record)).contains("surroundings"));
  record.scene.surroundings = make_surroundings();
  const json written = json::parse(format_scene_json(record));
  EXPECT_EQ(parse(written.dump()).scene.surroundings, record.scene.surroundings);

  json broken = written;
  broken["surroundings"]["cylinders"][0]["radius"] = -0.1;
  EXPECT_THAT([&] { parse(broken.dump()); },
              ::testing::ThrowsMessage<IoError>(HasSubstr("/surroundings/cylinders/0/radius")));
}

TEST(SceneJson, EverythingReadsBackBitByBit) {
  SceneRecord record = make_record(10);
  record.lift = {.lifted = 11, .force = 0.1 + 0.2, .given_up = {10, 4}, .dragged = {3, 10}, .moved = {{2, 1.0 / 3.0}}};
  record.scene.tubes[3].tube.kind = "pipe";
  const SceneRecord back = parse(format_scene_json(record));
  EXPECT_EQ(back.id, record.id);
  EXPECT_EQ(back.seed, record.seed);
  EXPECT_EQ(back.scene.bin, record.scene.bin);
  EXPECT_EQ(back.lift, record.lift);
  EXPECT_EQ(back.scene.scanner.rotation_deg, record.scene.scanner.rotation_deg);
  EXPECT_EQ(back.scene.scanner.horizontal_fov_deg, record.scene.scanner.horizontal_fov_deg);
  EXPECT_EQ(back.scene.scanner.region, ScanRegion::full);
  EXPECT_EQ(back.window, record.window);
  EXPECT_EQ(back.colors, record.colors);
  EXPECT_EQ(back.tube_pixels, record.tube_pixels);
  ASSERT_EQ(back.scene.tubes.size(), record.scene.tubes.size());
  for (std::size_t k = 0; k < record.scene.tubes.size(); ++k) {
    EXPECT_EQ(back.scene.tubes[k].world_from_tube.matrix(), record.scene.tubes[k].world_from_tube.matrix());
    EXPECT_EQ(back.scene.tubes[k].tube.nodes, record.scene.tubes[k].tube.nodes);
    EXPECT_EQ(back.scene.tubes[k].tube.cylinders, record.scene.tubes[k].tube.cylinders);
    EXPECT_EQ(back.scene.tubes[k].tube.mass, record.scene.tubes[k].tube.mass);
    EXPECT_EQ(back.scene.tubes[k].tube.kind, record.scene.tubes[k].tube.kind);
  }
  ASSERT_EQ(back.contacts.size(), 2U);
  EXPECT_EQ(back.contacts[1].depth, -1e-5);
  EXPECT_EQ(back.contacts[1].position, record.contacts[1].position);
  EXPECT_EQ(back.relations, record.relations);
  EXPECT_EQ(format_scene_json(back), format_scene_json(record));
}

TEST(SceneJson, FilesOfTheFirstVersionAreReadWithoutRelations) {
  json scene = json::parse(format_scene_json(make_record(3)));
  scene.erase("occlusions");
  scene.erase("entanglement");
  for (json& tube : scene["tubes"])
    for (const char* key : {"centerline", "amodal_pixels", "visible_fraction", "liftable"}) tube.erase(key);
  const SceneRecord record = parse(scene.dump());
  EXPECT_FALSE(record.relations);
  EXPECT_EQ(record.tube_pixels, make_record(3).tube_pixels);
}

TEST(SceneJson, ASceneWithoutTubesReadsBack) {
  const SceneRecord record = make_record(0);
  EXPECT_EQ(format_scene_json(parse(format_scene_json(record))), format_scene_json(record));
}

TEST(SceneJson, ConvenienceValuesAreWhatTheySay) {
  const SceneRecord record = make_record(3);
  const json scene = json::parse(format_scene_json(record));
  const json& tube = scene["tubes"][2];
  const json& q = tube["pose"]["quaternion"];
  const json& t = tube["pose"]["position"];
  const json& node = tube["nodes"][1];
  const Vec3 in_world = Quat(q[0].get<double>(), q[1].get<double>(), q[2].get<double>(), q[3].get<double>()) *
                            Vec3(node[0].get<double>(), node[1].get<double>(), node[2].get<double>()) +
                        Vec3(t[0].get<double>(), t[1].get<double>(), t[2].get<double>());
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(tube["nodes_in_world"][1][i].get<double>(), in_world[static_cast<int>(i)], 1e-12);
  EXPECT_NEAR(tube["length"].get<double>(), 0.5, 1e-12);
  // The image's right border is half the field of view off the axis.
  const json& intrinsics = scene["scanner"]["intrinsics"];
  const double half_fov = std::atan((1920.0 - intrinsics["cx"].get<double>()) / intrinsics["fx"].get<double>());
  EXPECT_NEAR(2.0 * half_fov, radians(record.scene.scanner.horizontal_fov_deg), 1e-12);
}

TEST(SceneJson, AgreesWithItsSchema) {
  const std::string path = ::testing::TempDir() + "tubebin_scene.json";
  const auto validate = [&](const std::string& text) {
    write_file_atomically(path, text);
    const std::string command =
        "python3 " TUBEBIN_SOURCE_DIR "/tests/validate_json.py " TUBEBIN_SOURCE_DIR "/docs/scene.schema.json " + path;
    const int status = std::system(command.c_str());
    std::filesystem::remove(path);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  };
  const std::string text = format_scene_json(make_record(4));
  const int result = validate(text);
  if (result == 77 || result == 127) GTEST_SKIP() << "needs python3 with jsonschema (Debian: python3-jsonschema)";
  EXPECT_EQ(result, 0);
  EXPECT_EQ(validate(format_scene_json(make_record(0))), 0);
  SceneRecord noisy = make_record(1);
  noisy.scene.scanner.effects.range_noise.sigma = 3e-4;
  noisy.scene.surroundings = make_surroundings();
  EXPECT_EQ(validate(format_scene_json(noisy)), 0);
  json wrong = json::parse(text);
  wrong["tubes"][1]["radius"] = -1;
  EXPECT_EQ(validate(wrong.dump()), 1);
}

TEST(SceneJson, EveryKeyIsInTheSchemaAndTheOtherWayRound) {
  const json schema = json::parse(read_file(TUBEBIN_SOURCE_DIR "/docs/scene.schema.json"));
  SceneRecord record = make_record(2);
  for (PlacedTube& tube : record.scene.tubes) {
    tube.tube.kind = "pipe";
    tube.tube.drawn = {{"tube.mass", 0.1}};
  }
  record.drawn = {{"bin.height", 0.2}};
  record.space.unit = CloudSpace::Unit::mm;
  record.depth_mm_per_unit = 0.1;
  record.scene.further_scanners = {record.scene.scanner};
  record.further_windows = {record.window};
  record.scene.scanner.effects.projector.enabled = true;  // else the scanner's effects are not there
  record.scene.bin.draft_deg = 3.0;                       // else it is a box
  record.scene.bin.mesh = "bin.stl";                      // else it has none
  record.scene.surroundings = make_surroundings();
  record.lift = {.lifted = 3, .force = 0.6, .given_up = {2}, .dragged = {1}, .moved = {{2, 0.004}}};
  const json scene = json::parse(format_scene_json(record));
  const auto keys = [](const json& object) {
    std::set<std::string> names;
    for (const auto& [key, value] : object.items()) names.insert(key);
    return names;
  };
  const json& top = schema["properties"];
  EXPECT_EQ(keys(scene), keys(top));
  EXPECT_EQ(keys(scene["cloud"]), keys(top["cloud"]["properties"]));
  EXPECT_EQ(keys(scene["bin"]), keys(top["bin"]["properties"]));
  const json &around = scene["surroundings"], &around_schema = top["surroundings"]["properties"];
  EXPECT_EQ(keys(around), keys(around_schema));
  EXPECT_EQ(keys(around["table"]), keys(schema["$defs"]["standing_box"]["properties"]));
  EXPECT_EQ(keys(around["boxes"][0]), keys(schema["$defs"]["standing_box"]["properties"]));
  for (const char* list : {"cylinders", "bins"})
    EXPECT_EQ(keys(around[list][0]), keys(around_schema[list]["items"]["properties"])) << list;
  EXPECT_EQ(keys(scene["scanner"]), keys(top["scanner"]["properties"]));
  EXPECT_EQ(keys(scene["lift"]), keys(top["lift"]["properties"]));
  EXPECT_EQ(keys(scene["lift"]["moved"][0]), keys(top["lift"]["properties"]["moved"]["items"]["properties"]));
  EXPECT_EQ(keys(scene["tubes"][0]), keys(schema["$defs"]["tube"]["properties"]));
  EXPECT_EQ(keys(scene["contacts"][0]), keys(schema["$defs"]["contact"]["properties"]));
  EXPECT_EQ(keys(scene["occlusions"][0]), keys(schema["$defs"]["occlusion"]["properties"]));
  EXPECT_EQ(keys(scene["entanglement"]), keys(top["entanglement"]["properties"]));
  EXPECT_EQ(keys(scene["entanglement"]["above"][0]), keys(schema["$defs"]["above"]["properties"]));
}

std::string error_of(const std::string& text) {
  try {
    parse(text);
  } catch (const IoError& error) {
    return error.what();
  }
  return "no error";
}

/// The error after setting what stands at the pointer.
std::string error_with(const std::string& pointer, const json& value) {
  json scene = json::parse(format_scene_json(make_record(3)));
  scene[json::json_pointer(pointer)] = value;
  return error_of(scene.dump());
}

std::string error_without(const std::string& parent, const std::string& key) {
  json scene = json::parse(format_scene_json(make_record(3)));
  scene[json::json_pointer(parent)].erase(key);
  return error_of(scene.dump());
}

TEST(SceneJson, ErrorsNameThePlaceTheValueAndWhatIsValid) {
  EXPECT_EQ(error_of(""), "scene.json: the file is empty; expected JSON");
  EXPECT_EQ(error_of("{\n \"a\": 1,\n}"), "scene.json:3:1: not valid JSON");
  EXPECT_EQ(error_of("[]"), "scene.json: /: [] is not valid; valid: an object");
  EXPECT_EQ(error_of("{}"), "scene.json: /format: missing");
  EXPECT_EQ(error_with("/tubes/1/radius", "thick"),
            "scene.json: /tubes/1/radius: \"thick\" is not valid; valid: a finite number");
  EXPECT_EQ(error_with("/tubes/2/nodes/0", {1, 2}),
            "scene.json: /tubes/2/nodes/0: [1,2] is not valid; valid: a list of 3");
  EXPECT_EQ(error_with("/scanner/region", "all"),
            "scene.json: /scanner/region: \"all\" is not valid; valid: one of bin, full, tubes");
  EXPECT_EQ(error_without("/tubes/0", "mass"), "scene.json: /tubes/0/mass: missing");
  EXPECT_EQ(error_with("/format_version", 2),
            "scene.json: /format_version: 2 is not valid; valid: 1, the version that this program reads");
}

TEST(SceneJson, ValuesThatCannotBeAreRefused) {
  EXPECT_THAT(error_with("/seed", -1), HasSubstr("/seed: -1 is not valid"));
  EXPECT_THAT(error_with("/bin/length", nullptr), HasSubstr("/bin/length: null is not valid"));
  EXPECT_THAT(error_with("/bin/color", {0, 256, 0}), HasSubstr("/bin/color/1: 256"));
  EXPECT_THAT(error_with("/scanner/width", 1.5), HasSubstr("/scanner/width: 1.5 is not valid; valid: a whole number"));
  EXPECT_THAT(error_with("/scanner/width", 1e30), HasSubstr("/scanner/width"));
  EXPECT_THAT(error_with("/scanner/range_max", 0.01), HasSubstr("beyond range_min"));
  EXPECT_THAT(error_with("/scanner/window/width", 1900), HasSubstr("/scanner/window/width: 1900"));
  EXPECT_THAT(error_with("/tubes/1/radius", 0), HasSubstr("/tubes/1/radius: 0 is not valid; valid: a number above 0"));
  EXPECT_THAT(error_with("/tubes/1/label", 3), HasSubstr("/tubes/1/label: 3"));
  EXPECT_THAT(error_with("/tubes/1/cylinders/0/node_b", 99), HasSubstr("/tubes/1/cylinders/0/node_b: 99"));
  EXPECT_THAT(error_with("/tubes/1/cylinders/0/node_b", 0), HasSubstr("nodes at different places"));
  EXPECT_THAT(error_with("/tubes/1/nodes", json::array()), HasSubstr("at least one node"));
  EXPECT_THAT(error_with("/tubes/1/pose/rotation/0", {1, 1, 1}), HasSubstr("the rows of a rotation matrix"));
  EXPECT_THAT(error_with("/tubes/1/pose/quaternion", {1, 0, 0, 0}), HasSubstr("unit quaternion"));
  EXPECT_THAT(error_with("/tubes/1/length", 0.6), HasSubstr("/tubes/1/length: 0.6 is not valid"));
  EXPECT_THAT(error_with("/tubes/1/nodes_in_world/0", {9, 9, 9}), HasSubstr("follows from pose and nodes"));
  EXPECT_THAT(error_with("/tubes/1/visible", false), HasSubstr("visible_pixels"));
  EXPECT_THAT(error_with("/contacts/0/label_b", 7), HasSubstr("/contacts/0/label_b: 7"));
  EXPECT_THAT(error_with("/tubes/1/centerline/0/0", {9, 9, 9}), HasSubstr("/tubes/1/centerline/0/0"));
  EXPECT_THAT(error_with("/tubes/1/visible_fraction", 0.5), HasSubstr("/tubes/1/visible_fraction: 0.5"));
  EXPECT_THAT(error_with("/tubes/0/liftable", true), HasSubstr("whether no tube is above it"));
  EXPECT_THAT(error_with("/occlusions/0/front", 1), HasSubstr("another body than behind"));
  EXPECT_THAT(error_with("/occlusions/0/behind", 4), HasSubstr("/occlusions/0/behind: 4"));
  EXPECT_THAT(error_with("/entanglement/above/0/upper", 3), HasSubstr("/entanglement/groups"));
  EXPECT_THAT(error_without("", "entanglement"), HasSubstr("/entanglement: missing"));
}

TEST(SceneJson, KeysOfLaterVersionsAreLeftAlone) { EXPECT_EQ(error_with("/tubes/0/dent", 3), "no error"); }

TEST(SceneJson, WhatIsNotFiniteIsNeverWritten) {
  SceneRecord record = make_record(2);
  record.contacts[0].depth = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(format_scene_json(record), std::invalid_argument);
  record = make_record(2);
  record.colors.pop_back();
  EXPECT_THROW(format_scene_json(record), std::invalid_argument);
}

TEST(SceneJson, DamageAndDeepNestingAreSurvived) {
  Random random(5);
  const std::string whole = format_scene_json(make_record(1));
  for (int round = 0; round < 2000; ++round) {
    std::string damaged = whole.substr(0, random.integer(0, 4) ? whole.size() : random.bits() % whole.size());
    for (int hit = random.integer(0, 3); hit > 0 && !damaged.empty(); --hit)
      damaged[random.bits() % damaged.size()] = static_cast<char>(random.integer(0, 255));
    const std::string error = error_of(damaged);
    if (error != "no error") {
      EXPECT_THAT(error, StartsWith("scene.json:"));
    }
  }
  EXPECT_THAT(error_of(std::string(1'000'000, '[')), StartsWith("scene.json:"));
}

}  // namespace
}  // namespace tubebin::scene
