#include <algorithm>
#include <limits>

#include "core/json_reader.hpp"
#include "scene/pixel_limit.hpp"
#include "scene/scene_json_format.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/scene/camera.hpp"
#include "tubebin/scene/scene_json.hpp"

namespace tubebin::scene {
namespace {

/// For values that are computed from others, in files that another program or a person may have edited.
constexpr double kDistanceTolerance = 1e-6;
constexpr double kPixelTolerance = 1e-6;

cloud::Color read_color(const JsonPlace& place) {
  cloud::Color color = 0;
  for (const JsonPlace& channel : place.elements(3))
    color = color << 8 | static_cast<cloud::Color>(channel.whole(0, 255));
  return color;
}

void read_header(const JsonPlace& root) {
  const JsonPlace format = root.at("format");
  if (format.text() != kSceneJsonFormat) format.fail(fmt::format("\"{}\"", kSceneJsonFormat));
  const JsonPlace version = root.at("format_version");
  if (version.whole(1, std::numeric_limits<int>::max()) != kSceneJsonVersion)
    version.fail(fmt::format("{}, the version that this program reads", kSceneJsonVersion));
}

Scanner read_scanner(const JsonPlace& place) {
  Scanner scanner;
  place.fields([&](Fields& fields) { describe(fields, scanner); });
  if (has_too_many_pixels(scanner))
    place.at("width").fail(fmt::format("up to {} pixels of width x height", kPixelsMax));
  if (scanner.range_max <= scanner.range_min) place.at("range_max").fail("beyond range_min");
  if (place.has("effects")) place.at("effects").fields([&](Fields& fields) { describe(fields, scanner.effects); });
  const Camera camera(scanner);
  const JsonPlace pose = place.at("pose");
  if (!pose.pose().isApprox(scanner.world_from_scanner(), kDistanceTolerance))
    pose.fail("the pose that follows from position and rotation_deg");
  const JsonPlace intrinsics = place.at("intrinsics");
  for (const char* key : {"fx", "fy"}) intrinsics.at(key).expect_near(camera.focal_length(), kPixelTolerance);
  intrinsics.at("cx").expect_near(scanner.width / 2.0, kPixelTolerance);
  intrinsics.at("cy").expect_near(scanner.height / 2.0, kPixelTolerance);
  return scanner;
}

Bin read_bin(const JsonPlace& place) {
  Bin bin;
  place.fields([&](Fields& fields) { describe_box(fields, bin); });
  if (place.has("draft_deg")) place.fields([&](Fields& fields) { describe_walls(fields, bin); });
  if (place.has("mesh")) place.fields([&](Fields& fields) { describe_mesh(fields, bin); });
  if (bin.corner_radius > std::min(bin.length, bin.width) / 2.0)
    place.at("corner_radius").fail("at most half of length and of width");
  return bin;
}

Surroundings read_surroundings(const JsonPlace& place) {
  Surroundings surroundings;
  place.fields([&](Fields& fields) { describe(fields, surroundings); });
  return surroundings;
}

PixelWindow read_window(const JsonPlace& place, const Scanner& scanner) {
  const auto read = [&](const char* key, int max) { return place.at(key).integer({0.0, static_cast<double>(max)}); };
  PixelWindow window;
  window.x = read("x", scanner.width);
  window.y = read("y", scanner.height);
  window.width = read("width", scanner.width - window.x);
  window.height = read("height", scanner.height - window.y);
  return window;
}

std::vector<tube::Cylinder> read_cylinders(const JsonPlace& place, const tube::Tube& tube) {
  const double last_node = static_cast<double>(tube.nodes.size()) - 1.0;
  std::vector<tube::Cylinder> cylinders;
  for (const JsonPlace& element : place.elements()) {
    tube::Cylinder cylinder = {element.at("node_a").integer({0.0, last_node}),
                               element.at("node_b").integer({0.0, last_node}), element.at("order").integer({0.0})};
    if (element.has("radius")) {
      cylinder.radius = element.at("radius").number();
      if (!(cylinder.radius > tube.wall_thickness)) element.at("radius").fail("a number above the wall's thickness");
    }
    if (!(tube.length(cylinder) > 0.0)) element.fail("a cylinder between nodes at different places");
    cylinders.push_back(cylinder);
  }
  return cylinders;
}

void check_nodes_in_world(const JsonPlace& place, const PlacedTube& placed) {
  const std::vector<JsonPlace> nodes = place.elements(placed.tube.nodes.size());
  for (int i = 0; i < static_cast<int>(nodes.size()); ++i) {
    const JsonPlace& node = nodes[static_cast<std::size_t>(i)];
    if (!((node.vector() - placed.node_in_world(i)).norm() <= kDistanceTolerance))
      node.fail("the node's place that follows from pose and nodes");
  }
}

void check_centerline(const JsonPlace& place, const PlacedTube& placed) {
  const std::vector<std::vector<int>> paths = centerline_paths(placed.tube);
  const std::vector<JsonPlace> given = place.elements(paths.size());
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const std::vector<JsonPlace> points = given[i].elements(paths[i].size());
    for (std::size_t j = 0; j < points.size(); ++j)
      if (!((points[j].vector() - placed.node_in_world(paths[i][j])).norm() <= kDistanceTolerance))
        points[j].fail("the node of the tube's path that stands here");
  }
}

PlacedTube read_tube(const JsonPlace& place, std::size_t label) {
  for (const char* key : {"id", "label"})
    if (place.at(key).whole(0, std::numeric_limits<cloud::Label>::max()) != label)
      place.at(key).fail(fmt::format("{}: tubes stand in the order of their labels", label));
  PlacedTube placed;
  tube::Tube& tube = placed.tube;
  if (place.has("kind")) tube.kind = place.at("kind").text();
  if (place.has("drawn")) tube.drawn = place.at("drawn").numbers();
  tube.radius = place.at("radius").number();
  if (tube.radius <= 0.0) place.at("radius").fail("a number above 0");
  tube.wall_thickness = place.at("wall_thickness").number({0.0, tube.radius});
  tube.mass = place.at("mass").number({0.0});
  for (const JsonPlace& node : place.at("nodes").elements()) tube.nodes.push_back(node.vector());
  if (tube.nodes.empty()) place.at("nodes").fail("at least one node");
  tube.cylinders = read_cylinders(place.at("cylinders"), tube);
  placed.world_from_tube = place.at("pose").pose();
  place.at("length").expect_near(tube.length(), kDistanceTolerance);
  check_nodes_in_world(place.at("nodes_in_world"), placed);
  if (place.has("centerline")) check_centerline(place.at("centerline"), placed);
  return placed;
}

std::size_t read_visible_pixels(const JsonPlace& place) {
  const std::size_t pixels = place.at("visible_pixels").whole(0, std::numeric_limits<std::uint32_t>::max());
  if (place.at("visible").flag() != (pixels > 0)) place.at("visible").fail("whether visible_pixels is above 0");
  return pixels;
}

Contact read_contact(const JsonPlace& place, std::size_t tube_count) {
  Contact contact;
  contact.label_a = static_cast<cloud::Label>(place.at("label_a").whole(0, tube_count));
  contact.label_b = static_cast<cloud::Label>(place.at("label_b").whole(0, tube_count));
  if (contact.label_a >= contact.label_b) place.at("label_b").fail("above label_a");
  contact.position = place.at("position").vector();
  contact.normal = place.at("normal").vector();
  contact.depth = place.at("depth").number();
  return contact;
}

cloud::Label read_tube_label(const JsonPlace& place, std::size_t tube_count, std::uint64_t lowest = 1) {
  return static_cast<cloud::Label>(place.whole(lowest, tube_count));
}

Occlusion read_occlusion(const JsonPlace& place, std::size_t tube_count) {
  Occlusion occlusion;
  occlusion.front = read_tube_label(place.at("front"), tube_count, 0);
  occlusion.behind = read_tube_label(place.at("behind"), tube_count);
  occlusion.pixels = place.at("pixels").whole(1, std::numeric_limits<std::uint32_t>::max());
  if (occlusion.front == occlusion.behind) place.at("front").fail("another body than behind");
  return occlusion;
}

Above read_above(const JsonPlace& place, std::size_t tube_count) {
  const Above pair = {read_tube_label(place.at("upper"), tube_count), read_tube_label(place.at("lower"), tube_count)};
  if (pair.upper == pair.lower) place.at("upper").fail("another tube than lower");
  return pair;
}

void check_groups(const JsonPlace& place, const std::vector<LabelGroup>& expected) {
  std::vector<LabelGroup> groups;
  for (const JsonPlace& group : place.elements()) {
    groups.emplace_back();
    for (const JsonPlace& label : group.elements())
      groups.back().push_back(static_cast<cloud::Label>(label.whole(1, std::numeric_limits<cloud::Label>::max())));
  }
  if (groups != expected) place.fail("the groups that follow from above");
}

/// What the file says of the pile; tubes' values that derive from it must agree.
PileRelations read_relations(const JsonPlace& root, const std::vector<std::size_t>& visible_pixels) {
  const std::size_t tube_count = visible_pixels.size();
  PileRelations relations;
  for (const JsonPlace& occlusion : root.at("occlusions").elements())
    relations.occlusions.push_back(read_occlusion(occlusion, tube_count));
  const JsonPlace entanglement = root.at("entanglement");
  for (const JsonPlace& pair : entanglement.at("above").elements())
    relations.above.push_back(read_above(pair, tube_count));
  check_groups(entanglement.at("groups"), entangled_groups(tube_count, relations.above));
  const std::vector<JsonPlace> tubes = root.at("tubes").elements(tube_count);
  for (std::size_t k = 0; k < tube_count; ++k) {
    relations.amodal_pixels.push_back(tubes[k].at("amodal_pixels").whole(0, std::numeric_limits<std::uint32_t>::max()));
    tubes[k]
        .at("visible_fraction")
        .expect_near(visible_fraction(visible_pixels[k], relations.amodal_pixels[k]), kDistanceTolerance);
    if (tubes[k].at("liftable").flag() != relations.is_liftable(static_cast<cloud::Label>(k + 1)))
      tubes[k].at("liftable").fail("whether no tube is above it");
  }
  return relations;
}

/// There was one tube more in the pile before.
Lift read_lift(const JsonPlace& place, std::size_t tube_count) {
  Lift lift;
  lift.lifted = read_tube_label(place.at("lifted"), tube_count + 1);
  lift.force = place.at("force").number();
  for (const JsonPlace& label : place.at("dragged").elements())
    lift.dragged.push_back(read_tube_label(label, tube_count));
  for (const JsonPlace& tube : place.at("moved").elements())
    lift.moved.push_back({read_tube_label(tube.at("label"), tube_count), tube.at("distance").number({0.0})});
  if (!place.has("given_up")) return lift;
  for (const JsonPlace& label : place.at("given_up").elements())
    lift.given_up.push_back(read_tube_label(label, tube_count + 1));
  return lift;
}

}  // namespace

SceneRecord parse_scene_json(std::string_view text, const std::string& name) {
  const nlohmann::json json = parse_json(text, name);
  const JsonPlace root(json, name);
  read_header(root);
  SceneRecord record;
  record.id = root.at("id").text();
  record.seed = root.at("seed").whole(0, std::numeric_limits<std::uint64_t>::max());
  if (root.has("cloud")) root.at("cloud").fields([&](Fields& fields) { describe(fields, record.space); });
  if (root.has("depth_image")) record.depth_mm_per_unit = root.at("depth_image").at("mm_per_unit").number({1e-6, 1e6});
  if (root.has("drawn")) record.drawn = root.at("drawn").numbers();
  record.scene.bin = read_bin(root.at("bin"));
  record.colors.push_back(read_color(root.at("bin").at("color")));
  if (root.has("surroundings")) record.scene.surroundings = read_surroundings(root.at("surroundings"));
  record.scene.scanner = read_scanner(root.at("scanner"));
  record.window = read_window(root.at("scanner").at("window"), record.scene.scanner);
  if (root.has("further_scanners"))
    for (const JsonPlace& scanner : root.at("further_scanners").elements()) {
      record.scene.further_scanners.push_back(read_scanner(scanner));
      record.further_windows.push_back(read_window(scanner.at("window"), record.scene.further_scanners.back()));
    }
  for (const JsonPlace& tube : root.at("tubes").elements()) {
    record.scene.tubes.push_back(read_tube(tube, record.scene.tubes.size() + 1));
    record.colors.push_back(read_color(tube.at("color")));
    record.tube_pixels.push_back(read_visible_pixels(tube));
  }
  for (const JsonPlace& contact : root.at("contacts").elements())
    record.contacts.push_back(read_contact(contact, record.scene.tubes.size()));
  if (root.has("lift")) record.lift = read_lift(root.at("lift"), record.scene.tubes.size());
  if (root.has("occlusions") || root.has("entanglement")) record.relations = read_relations(root, record.tube_pixels);
  return record;
}

SceneRecord read_scene_json(const std::string& path) { return parse_scene_json(read_file(path), path); }

cloud::Cloud parse_scene_cloud(std::string_view bytes, const std::string& name, const SceneRecord& record) {
  return in_world(cloud::parse_cloud(bytes, name, record.space.metres_per_unit()), record.space,
                  record.scene.scanner.world_from_scanner());
}

void require_same_scene(const SceneRecord& record, const cloud::Cloud& cloud, const std::string& name,
                        const std::string& place) {
  if (name == "." || name == record.id || name.ends_with("/" + record.id)) return;
  std::vector<std::size_t> points(record.tube_pixels.size(), 0);
  for (std::size_t i = 0; i < cloud.labels.size(); ++i)
    if (cloud::is_finite(cloud.points[i]) && cloud.labels[i] > 0 && cloud.labels[i] <= points.size())
      ++points[cloud.labels[i] - 1];
  if (points == record.tube_pixels) return;  // both were copied under another name
  throw_io_error(
      "{}: /id: \"{}\" is not valid; valid: \"{}\", the scene that the file stands in and whose cloud is beside it",
      place, record.id, name);
}

}  // namespace tubebin::scene
