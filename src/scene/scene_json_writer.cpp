#include <stdexcept>

#include "core/json_writer.hpp"
#include "scene/scene_json_format.hpp"
#include "tubebin/core/version.hpp"
#include "tubebin/scene/camera.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin::scene {
namespace {

OrderedJson color_to_json(cloud::Color color) { return {color >> 16 & 0xFF, color >> 8 & 0xFF, color & 0xFF}; }

OrderedJson bin_to_json(Bin bin, cloud::Color color) {
  OrderedJson json = {{"label", 0}, {"color", color_to_json(color)}};
  json.update(fields_to_json([&](Fields& fields) { describe_box(fields, bin); }));
  if (!bin.is_box()) json.update(fields_to_json([&](Fields& fields) { describe_walls(fields, bin); }));
  if (bin.has_mesh()) json.update(fields_to_json([&](Fields& fields) { describe_mesh(fields, bin); }));
  return json;
}

OrderedJson surroundings_to_json(Surroundings surroundings) {
  OrderedJson json = {{"label", 0}};
  json.update(fields_to_json([&](Fields& fields) { describe(fields, surroundings); }));
  return json;
}

OrderedJson scanner_to_json(Scanner scanner, const PixelWindow& window) {
  const Camera camera(scanner);
  OrderedJson json = fields_to_json([&](Fields& fields) { describe(fields, scanner); });
  json["pose"] = to_json(scanner.world_from_scanner());
  json["intrinsics"] = {{"fx", to_json(camera.focal_length())},
                        {"fy", to_json(camera.focal_length())},
                        {"cx", scanner.width / 2.0},
                        {"cy", scanner.height / 2.0}};
  if (scanner.effects.any())
    json["effects"] = fields_to_json([&](Fields& fields) { describe(fields, scanner.effects); });
  json["window"] = {{"x", window.x}, {"y", window.y}, {"width", window.width}, {"height", window.height}};
  return json;
}

OrderedJson further_scanners_to_json(const SceneRecord& record) {
  OrderedJson scanners = OrderedJson::array();
  for (std::size_t k = 0; k < record.further_windows.size(); ++k)
    scanners.push_back(scanner_to_json(record.scene.further_scanners[k], record.further_windows[k]));
  return scanners;
}

OrderedJson centerline_to_json(const PlacedTube& placed) {
  OrderedJson paths = OrderedJson::array();
  for (const std::vector<int>& path : centerline_paths(placed.tube)) {
    OrderedJson points = OrderedJson::array();
    for (const int node : path) points.push_back(to_json(placed.node_in_world(node)));
    paths.push_back(std::move(points));
  }
  return paths;
}

OrderedJson tube_to_json(const PlacedTube& placed, std::size_t label, cloud::Color color, std::size_t visible_pixels) {
  const tube::Tube& tube = placed.tube;
  OrderedJson nodes = OrderedJson::array(), nodes_in_world = OrderedJson::array(), cylinders = OrderedJson::array();
  for (int i = 0; i < static_cast<int>(tube.nodes.size()); ++i) {
    nodes.push_back(to_json(tube.nodes[static_cast<std::size_t>(i)]));
    nodes_in_world.push_back(to_json(placed.node_in_world(i)));
  }
  for (const tube::Cylinder& cylinder : tube.cylinders) {
    cylinders.push_back({{"node_a", cylinder.node_a}, {"node_b", cylinder.node_b}, {"order", cylinder.order}});
    if (cylinder.radius > 0.0) cylinders.back()["radius"] = to_json(cylinder.radius);
  }
  OrderedJson json = {{"id", label}, {"label", label}};
  if (!tube.kind.empty()) json["kind"] = tube.kind;
  if (!tube.drawn.empty()) json["drawn"] = tube.drawn;
  json.update({{"color", color_to_json(color)},
               {"radius", to_json(tube.radius)},
               {"wall_thickness", to_json(tube.wall_thickness)},
               {"mass", to_json(tube.mass)},
               {"length", to_json(tube.length())},
               {"nodes", std::move(nodes)},
               {"cylinders", std::move(cylinders)},
               {"pose", to_json(placed.world_from_tube)},
               {"nodes_in_world", std::move(nodes_in_world)},
               {"centerline", centerline_to_json(placed)},
               {"visible_pixels", visible_pixels},
               {"visible", visible_pixels > 0}});
  return json;
}

OrderedJson contact_to_json(const Contact& contact) {
  return {{"label_a", contact.label_a},
          {"label_b", contact.label_b},
          {"position", to_json(contact.position)},
          {"normal", to_json(contact.normal)},
          {"depth", to_json(contact.depth)}};
}

void add_relations(const SceneRecord& record, const PileRelations& relations, OrderedJson& json) {
  for (std::size_t k = 0; k < record.scene.tubes.size(); ++k) {
    OrderedJson& tube = json["tubes"][k];
    tube["amodal_pixels"] = relations.amodal_pixels[k];
    tube["visible_fraction"] = visible_fraction(record.tube_pixels[k], relations.amodal_pixels[k]);
    tube["liftable"] = relations.is_liftable(static_cast<cloud::Label>(k + 1));
  }
  json["occlusions"] = OrderedJson::array();
  for (const Occlusion& occlusion : relations.occlusions)
    json["occlusions"].push_back(
        {{"front", occlusion.front}, {"behind", occlusion.behind}, {"pixels", occlusion.pixels}});
  OrderedJson above = OrderedJson::array();
  for (const Above& pair : relations.above) above.push_back({{"upper", pair.upper}, {"lower", pair.lower}});
  json["entanglement"] = {{"above", std::move(above)},
                          {"groups", entangled_groups(record.scene.tubes.size(), relations.above)}};
}

OrderedJson lift_to_json(const Lift& lift) {
  OrderedJson moved = OrderedJson::array();
  for (const MovedTube& tube : lift.moved)
    moved.push_back({{"label", tube.label}, {"distance", to_json(tube.distance)}});
  OrderedJson json = {
      {"lifted", lift.lifted}, {"force", to_json(lift.force)}, {"dragged", lift.dragged}, {"moved", std::move(moved)}};
  if (!lift.given_up.empty()) json["given_up"] = lift.given_up;
  return json;
}

void check_consistent(const SceneRecord& record) {
  const std::size_t tubes = record.scene.tubes.size();
  if (record.colors.size() != tubes + 1 || record.tube_pixels.size() != tubes)
    throw std::invalid_argument(fmt::format("scene {} of {} tubes with {} colours and {} pixel counts", record.id,
                                            tubes, record.colors.size(), record.tube_pixels.size()));
  if (record.further_windows.size() != record.scene.further_scanners.size())
    throw std::invalid_argument(fmt::format("scene {} of {} further scanners with {} windows", record.id,
                                            record.scene.further_scanners.size(), record.further_windows.size()));
  if (record.relations && record.relations->amodal_pixels.size() != tubes)
    throw std::invalid_argument(fmt::format("scene {} of {} tubes with {} amodal pixel counts", record.id, tubes,
                                            record.relations->amodal_pixels.size()));
}

}  // namespace

std::string format_scene_json(const SceneRecord& record) {
  check_consistent(record);
  OrderedJson json = {{"format", kSceneJsonFormat},
                      {"format_version", kSceneJsonVersion},
                      {"tool_version", tool_version()},
                      {"units", {{"length", "m"}, {"mass", "kg"}, {"angle_deg", "degree"}, {"image", "pixel"}}},
                      {"id", record.id},
                      {"seed", record.seed}};
  if (record.space != CloudSpace{}) {
    CloudSpace space = record.space;
    json["cloud"] = fields_to_json([&](Fields& fields) { describe(fields, space); });
  }
  if (record.depth_mm_per_unit) json["depth_image"] = {{"mm_per_unit", to_json(*record.depth_mm_per_unit)}};
  if (!record.drawn.empty()) json["drawn"] = record.drawn;
  json.update({{"bin", bin_to_json(record.scene.bin, record.colors[0])},
               {"scanner", scanner_to_json(record.scene.scanner, record.window)},
               {"tubes", OrderedJson::array()},
               {"contacts", OrderedJson::array()}});
  if (record.scene.surroundings) json["surroundings"] = surroundings_to_json(*record.scene.surroundings);
  if (!record.further_windows.empty()) json["further_scanners"] = further_scanners_to_json(record);
  for (std::size_t k = 0; k < record.scene.tubes.size(); ++k)
    json["tubes"].push_back(tube_to_json(record.scene.tubes[k], k + 1, record.colors[k + 1], record.tube_pixels[k]));
  for (const Contact& contact : record.contacts) json["contacts"].push_back(contact_to_json(contact));
  if (record.relations) add_relations(record, *record.relations, json);
  if (record.lift) json["lift"] = lift_to_json(*record.lift);
  return format_json(json);
}

}  // namespace tubebin::scene
