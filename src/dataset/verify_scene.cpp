#include "dataset/verify_scene.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "dataset/pile.hpp"
#include "dataset/randomization.hpp"
#include "dataset/surface_distance.hpp"
#include "dataset/verify_cloud.hpp"
#include "dataset/verify_settings.hpp"
#include "tubebin/core/file_record.hpp"
#include "tubebin/dataset/generate_scene.hpp"
#include "tubebin/scene/depth_image.hpp"
#include "tubebin/scene/scene_json.hpp"
#include "tubebin/scene/tubes_txt.hpp"

namespace tubebin::dataset {
namespace {

using Problems = std::vector<std::string>;

// tubes.txt is text; its distances round-trip to a nanometre, its directions a little less.
constexpr double kTextTolerance = 1e-8;
// Where tubes collide follows where they are scanned within 1 mm.
constexpr double kContactTolerance = 1e-3;

void check_identity(const scene::SceneRecord& scene, const DatasetConfig& config, const SceneId& id,
                    const ManifestRecord& record, Problems& problems) {
  if (scene.id != id.name()) problems.push_back(fmt::format("scene.json calls itself {}", scene.id));
  if (scene.seed != record.seed)
    problems.push_back(fmt::format("scene.json has seed {}, recorded is {}", scene.seed, record.seed));
  if (scene.scene.tubes.size() != static_cast<std::size_t>(id.tubes_in_bin()))
    problems.push_back(fmt::format("scene.json has {} tubes", scene.scene.tubes.size()));
  if (scene.scene.bin != config.bin) problems.push_back("scene.json has another bin than config.yaml");
}

void check_kinds(const scene::SceneRecord& scene, const DatasetConfig& config, Problems& problems) {
  std::map<std::string, int> count_of;
  for (const scene::PlacedTube& tube : scene.scene.tubes) ++count_of[tube.tube.kind];
  if (config.kinds.empty()) {
    if (!count_of.empty() && !count_of.contains("")) problems.push_back("scene.json has kinds, config.yaml has none");
    return;
  }
  for (std::size_t i = 0; i < config.kinds.size(); ++i) {
    const std::string name = tube::kind_name(config.kinds, i);
    const int count = count_of[name];
    count_of.erase(name);
    if ((!scene.lift && count < config.kinds[i].count) ||
        (config.kinds[i].share == 0.0 && count > config.kinds[i].count))
      problems.push_back(fmt::format("scene.json has {} tubes of kind {}, config.yaml asks for {}", count, name,
                                     config.kinds[i].count));
  }
  for (const auto& [name, count] : count_of)
    problems.push_back(
        fmt::format("scene.json has {} tubes of kind '{}', which config.yaml does not have", count, name));
}

/// Of a pile that nothing was lifted from, whose seed draws it anew.
void check_surroundings(const scene::SceneRecord& scene, const DatasetConfig& config, Problems& problems) {
  if (!scene.lift && scene.scene.surroundings != draw_surroundings(config, scene.seed, scene.scene.tubes).surroundings)
    problems.push_back("scene.json has other surroundings than config.yaml and the seed give");
}

void check_colors(const scene::SceneRecord& scene, Problems& problems) {
  const std::set<cloud::Color> different(scene.colors.begin(), scene.colors.end());
  if (scene.colors.size() != scene.scene.tubes.size() + 1 || different.size() != scene.colors.size() ||
      different.contains(cloud::kNullColor))
    problems.push_back(fmt::format("scene.json has {} different colours for {} tubes and the bin", different.size(),
                                   scene.scene.tubes.size()));
}

void check_tubes_txt(const std::vector<scene::PlacedTube>& read, const scene::SceneRecord& scene, Problems& problems) {
  bool same = read.size() == scene.scene.tubes.size();
  for (std::size_t k = 0; same && k < read.size(); ++k) {
    const scene::PlacedTube& tube = scene.scene.tubes[k];
    same = read[k].tube.nodes.size() == tube.tube.nodes.size();
    for (int node = 0; same && node < static_cast<int>(tube.tube.nodes.size()); ++node)
      same = (read[k].node_in_world(node) - tube.node_in_world(node)).norm() < kTextTolerance;
  }
  if (!same) problems.push_back("tubes.txt has other tubes than scene.json");
}

void check_contacts(const scene::SceneRecord& scene, const DatasetConfig& config, Problems& problems) {
  scene::Scene solid = scene.scene;  // bores are filled where tubes collide
  for (scene::PlacedTube& tube : solid.tubes) tube.tube.wall_thickness = 0.0;
  solid.surroundings.reset();  // no part of the simulation
  const std::vector<BodySurface> surfaces = surfaces_of(solid);
  for (const scene::Contact& contact : scene.contacts) {
    const auto off = [&](cloud::Label label) {
      return label >= surfaces.size() ||
             surfaces[label].distance(contact.position) > std::abs(contact.depth) + kContactTolerance;
    };
    if (off(contact.label_a) || off(contact.label_b))
      problems.push_back(
          fmt::format("the contact of {} and {} is not where both are", contact.label_a, contact.label_b));
    if (contact.depth > config.physics.penetration_max)
      problems.push_back(fmt::format("{} and {} interpenetrate by {:.3f} mm, more than the {:.3f} mm allowed",
                                     contact.label_a, contact.label_b, contact.depth * 1e3,
                                     config.physics.penetration_max * 1e3));
  }
}

/// Tubes from which no chain of contacts leads to the bin.
void check_held(const scene::SceneRecord& scene, Problems& problems) {
  std::set<cloud::Label> held = {0};
  for (std::size_t before = 0; before != held.size();) {
    before = held.size();
    for (const scene::Contact& contact : scene.contacts) {
      if (held.contains(contact.label_a)) held.insert(contact.label_b);
      if (held.contains(contact.label_b)) held.insert(contact.label_a);
    }
  }
  for (cloud::Label k = 1; k <= scene.scene.tubes.size(); ++k)
    if (!held.contains(k)) problems.push_back(fmt::format("tube {} floats: no contacts lead from it to the bin", k));
}

/// That the pile is the one of the step before without the tube that was lifted, and moved as it says.
void check_lift(const scene::DatasetFiles& files, const scene::SceneRecord& scene, SceneId id, Problems& problems) {
  if (scene.lift.has_value() != (id.step > 0))
    problems.push_back(id.step > 0 ? "scene.json does not say what was lifted" : "scene.json tells of a lift");
  if (!scene.lift || id.step <= 0) return;
  --id.step;
  const scene::SceneRecord before =
      scene::parse_scene_json(files.read(id.name(), "scene.json"), files.place(id.name(), "scene.json"));
  if (scene.lift->lifted > before.scene.tubes.size())
    return problems.push_back(fmt::format("tube {} was lifted, of {}", scene.lift->lifted, before.scene.tubes.size()));
  const std::vector<scene::PlacedTube> left = scene::without(before.scene.tubes, scene.lift->lifted);
  if (scene.scene.surroundings != before.scene.surroundings)
    problems.push_back(fmt::format("what stands around the bin is not what {} has there", id.name()));
  const bool same = std::ranges::equal(left, scene.scene.tubes, [](const auto& a, const auto& b) {
    return a.tube.nodes == b.tube.nodes && a.tube.cylinders == b.tube.cylinders && a.tube.radius == b.tube.radius &&
           a.tube.drawn == b.tube.drawn;
  });
  if (before.drawn != scene.drawn)
    problems.push_back(fmt::format("scene.json has other drawn numbers than that of {}", id.name()));
  if (!same) problems.push_back(fmt::format("the tubes are not those that {} has beside the lifted one", id.name()));
  else if (scene::find_moved(left, scene.scene.tubes) != scene.lift->moved)
    problems.push_back(fmt::format("the tubes did not move from where {} has them as scene.json says", id.name()));
}

void check_relations(const scene::SceneRecord& scene, Problems& problems) {
  if (!scene.relations) problems.push_back("scene.json does not say who covers whom");
  else if (*scene.relations != relate_pile(scene.scene))
    problems.push_back("scene.json's amodal pixels, occlusions or entanglement are not those of its tubes");
}

void check_content(const scene::DatasetFiles& files, const DatasetConfig& undrawn, const SceneId& id,
                   const ManifestRecord& record, Problems& problems) {
  const auto parse = [&](const auto& parser, const std::string& file) {
    return parser(files.read(record.id, file), files.place(record.id, file));
  };
  scene::SceneRecord scene = parse(scene::parse_scene_json, "scene.json");
  const auto cloud_parser = [&](const std::string& bytes, const std::string& name) {
    return scene::parse_scene_cloud(bytes, name, scene);
  };
  const DatasetConfig config = with_numbers(undrawn, scene.drawn);
  check_identity(scene, config, id, record, problems);
  if (scene.scene.bin == config.bin) scene.scene.bin.surface = config.bin.surface;
  const auto add = [&](const Problems& found) { problems.insert(problems.end(), found.begin(), found.end()); };
  add(check_settings(scene, config));
  check_kinds(scene, config, problems);
  check_surroundings(scene, config, problems);
  check_colors(scene, problems);
  check_tubes_txt(parse(scene::parse_tubes_txt, "tubes.txt"), scene, problems);
  check_contacts(scene, config, problems);
  check_held(scene, problems);
  check_relations(scene, problems);
  check_lift(files, scene, id, problems);
  if (record.physics.largest_drift > config.physics.drift_max)
    problems.push_back(
        fmt::format("a tube moved by {:.3f} mm in the check at the end", record.physics.largest_drift * 1e3));
  const auto cloud_file = [&](const char* name) {
    return parse(cloud_parser, std::string(name) + extension(config.output.format));
  };
  const cloud::Cloud cloud = cloud_file("cloud");
  if (problems.empty()) add(check_cloud(cloud, scene));
  if (problems.empty() && scene.depth_mm_per_unit)
    add(check_depth_image(scene::read_depth_image(files, record.id, scene), cloud, scene));
  if (problems.empty() && config.output.clean_cloud) add(check_clean_cloud(cloud_file("cloud_clean"), scene));
}

}  // namespace

std::vector<std::string> check_files(const scene::DatasetFiles& files, const ManifestRecord& record) {
  Problems problems;
  for (const auto& [name, expected] : record.files) try {
      if (!files.has(record.id, name)) {
        problems.push_back(name.str() + " is missing");
        continue;
      }
      const FileRecord found = record_bytes(files.read(record.id, name));
      if (found.bytes != expected.bytes)
        problems.push_back(fmt::format("{} has {} bytes, recorded are {}", name, found.bytes, expected.bytes));
      else if (found.xxh128 != expected.xxh128)
        problems.push_back(fmt::format("{} has hash {}, recorded is {}", name, found.xxh128, expected.xxh128));
    } catch (const IoError& error) {
      problems.emplace_back(error.what());
    }
  return problems;
}

std::vector<std::string> verify_scene(const scene::DatasetFiles& files, const DatasetConfig& config, const SceneId& id,
                                      const ManifestRecord& record) {
  Problems problems;
  try {
    problems = check_files(files, record);
    // Files that aren't as they were written make no sense to look into.
    if (problems.empty()) check_content(files, config, id, record, problems);
  } catch (const IoError& error) {
    problems.emplace_back(error.what());
  }
  return problems;
}

}  // namespace tubebin::dataset
