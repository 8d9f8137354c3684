#include "dataset/verify_scene.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "dataset/pile.hpp"
#include "dataset/randomization.hpp"
#include "dataset/surface_distance.hpp"
#include "dataset/verify_settings.hpp"
#include "tubebin/core/file_record.hpp"
#include "tubebin/dataset/generate_scene.hpp"
#include "tubebin/scan/scanner.hpp"
#include "tubebin/scene/depth_image.hpp"
#include "tubebin/scene/scene_json.hpp"
#include "tubebin/scene/tubes_txt.hpp"

namespace tubebin::dataset {
namespace {

using Problems = std::vector<std::string>;

// Exactness of a noise-free scan: 0.005 mm.
constexpr double kSurfaceTolerance = 5e-6;
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

std::vector<BodySurface> surfaces_of(const scene::Scene& scene) {
  std::vector<BodySurface> surfaces = {BodySurface(scene)};
  for (const scene::PlacedTube& tube : scene.tubes) surfaces.emplace_back(tube);
  return surfaces;
}

void check_sources(const cloud::Cloud& cloud, const scene::SceneRecord& scene, Problems& problems) {
  const std::size_t source_count = scene.scene.source_count();
  if (cloud.sources.size() != (source_count > 1 ? cloud.size() : 0))
    problems.push_back(fmt::format("{} of the cloud's {} points say which of {} scanners saw them",
                                   cloud.sources.size(), cloud.size(), source_count));
  else if (std::ranges::any_of(cloud.sources, [&](std::uint32_t source) { return source >= source_count; }))
    problems.push_back(fmt::format("the cloud has points of other sources than its {} scanners", source_count));
}

void check_cloud_layout(const cloud::Cloud& cloud, const scene::SceneRecord& scene, Problems& problems) {
  const bool is_organized = scene.scene.further_scanners.empty() &&
                            scene.scene.scanner.region != scene::ScanRegion::tubes &&
                            scene.window.width * scene.window.height > 0;
  if (is_organized && (cloud.width != static_cast<std::uint32_t>(scene.window.width) ||
                       cloud.height != static_cast<std::uint32_t>(scene.window.height)))
    problems.push_back(fmt::format("the cloud has {} x {} points, the window of scene.json {} x {}", cloud.width,
                                   cloud.height, scene.window.width, scene.window.height));
  if (cloud.colors.size() != cloud.size() || cloud.labels.size() != cloud.size())
    problems.push_back("the cloud has no colour or no label for each point");
  check_sources(cloud, scene, problems);
}

/// Labels and colours; that points lie on their surfaces where `exact` says so. Returns the tubes' pixels.
std::vector<std::size_t> check_points(const cloud::Cloud& cloud, const scene::SceneRecord& scene, bool exact,
                                      Problems& problems) {
  const std::vector<BodySurface> surfaces = surfaces_of(scene.scene);
  std::vector<std::size_t> pixels(surfaces.size(), 0);
  std::size_t unknown = 0, miscolored = 0, off_surface = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const cloud::Label label = cloud.labels[i];
    if (!cloud::is_finite(cloud.points[i])) {
      miscolored += label != 0 || cloud.colors[i] != cloud::kNullColor;
    } else if (label >= surfaces.size()) {
      ++unknown;
    } else {
      ++pixels[label];
      miscolored += cloud.colors[i] != scene.colors[label];
      off_surface += exact && !(surfaces[label].distance(cloud.points[i].cast<double>()) <= kSurfaceTolerance);
    }
  }
  if (unknown > 0) problems.push_back(fmt::format("{} points have labels of no tube", unknown));
  if (miscolored > 0) problems.push_back(fmt::format("{} points have another colour than their label", miscolored));
  if (off_surface > 0)
    problems.push_back(fmt::format("{} points lie more than {} mm off the surface of their label", off_surface,
                                   kSurfaceTolerance * 1e3));
  pixels.erase(pixels.begin());
  return pixels;
}

/// How many points are others than those of `expected`: of another label, missing, or farther off than exact surfaces
/// may be.
std::size_t count_differences(const cloud::Cloud& cloud, const cloud::Cloud& expected) {
  if (cloud.size() != expected.size()) return std::max(cloud.size(), expected.size());
  std::size_t differences = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const cloud::Point &found = cloud.points[i], &wanted = expected.points[i];
    const bool same_place = cloud::is_finite(wanted) ? (found - wanted).norm() <= static_cast<float>(kSurfaceTolerance)
                                                     : !cloud::is_finite(found);
    differences += !same_place || cloud.labels[i] != expected.labels[i] ||
                   (!expected.sources.empty() && cloud.sources[i] != expected.sources[i]);
  }
  return differences;
}

/// A cloud with effects is off the surfaces by design, by its seed's noise. So it is compared with what the seed gives,
/// and the surfaces with its noise-free twin.
void check_effects(const cloud::Cloud& cloud, const scene::SceneRecord& scene, Problems& problems) {
  if (const std::size_t differing = count_differences(cloud, scan::scan_from_all(scene.scene, scene.seed).cloud))
    problems.push_back(fmt::format("{} points are not what the scanner's effects make of the scene", differing));
  check_points(scan::scan_exactly_from_all(scene.scene).cloud, scene, true, problems);
}

void check_cloud(const cloud::Cloud& cloud, const scene::SceneRecord& scene, Problems& problems) {
  bool has_effects = scene.scene.scanner.effects.any();
  for (const scene::Scanner& scanner : scene.scene.further_scanners) has_effects |= scanner.effects.any();
  const std::vector<std::size_t> pixels = check_points(cloud, scene, !has_effects, problems);
  if (pixels != scene.tube_pixels)
    problems.push_back(fmt::format("the cloud shows [{}] pixels of the tubes, scene.json says [{}]",
                                   fmt::join(pixels, ", "), fmt::join(scene.tube_pixels, ", ")));
  if (has_effects) check_effects(cloud, scene, problems);
}

void check_clean_cloud(const cloud::Cloud& clean, const scene::SceneRecord& scene, Problems& problems) {
  check_cloud_layout(clean, scene, problems);
  if (!problems.empty()) return;
  check_points(clean, scene, true, problems);
  if (const std::size_t differing = count_differences(clean, scan::scan_exactly_from_all(scene.scene).cloud))
    problems.push_back(fmt::format("{} points of cloud_clean are not the scene as exact rays see it", differing));
}

/// A cloud in the camera's frame or in millimetres was rounded anew: its depth may be one unit beside the image's.
void compare_depth_image(const scene::DepthImage& found, const cloud::Cloud& cloud, const scene::SceneRecord& scene,
                         Problems& problems) {
  const scene::DepthImage expected = scene::depth_image(cloud, scene);
  if (found.mm_per_unit != expected.mm_per_unit)
    problems.push_back(fmt::format("scene.json has {} mm a unit of depth.png, its scanner's range gives {}",
                                   found.mm_per_unit, expected.mm_per_unit));
  std::size_t differing = 0;
  for (std::size_t i = 0; i < expected.depths.size(); ++i)
    differing += std::abs(found.depths[i] - expected.depths[i]) > 1 || found.labels[i] != expected.labels[i];
  if (differing > 0)
    problems.push_back(fmt::format("{} pixels of depth.png or labels.png are not those of the cloud", differing));
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
  const scene::SceneRecord scene = parse(scene::parse_scene_json, "scene.json");
  const auto cloud_parser = [&](const std::string& bytes, const std::string& name) {
    return scene::parse_scene_cloud(bytes, name, scene);
  };
  const DatasetConfig config = with_numbers(undrawn, scene.drawn);
  check_identity(scene, config, id, record, problems);
  const Problems settings = check_settings(scene, config);
  problems.insert(problems.end(), settings.begin(), settings.end());
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
  const cloud::Cloud cloud = parse(cloud_parser, std::string("cloud") + extension(config.output.format));
  check_cloud_layout(cloud, scene, problems);
  if (problems.empty()) check_cloud(cloud, scene, problems);
  if (problems.empty() && scene.depth_mm_per_unit)
    compare_depth_image(scene::read_depth_image(files, record.id, scene), cloud, scene, problems);
  if (config.output.clean_cloud)
    check_clean_cloud(parse(cloud_parser, std::string("cloud_clean") + extension(config.output.format)), scene,
                      problems);
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
