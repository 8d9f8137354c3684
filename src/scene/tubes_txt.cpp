#include "tubebin/scene/tubes_txt.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <set>

#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/core/text_scan.hpp"

namespace tubebin::scene {
namespace {

/// The published files keep six digits: a millionth of a metre, and so an axis of 20 mm to some 1e-4.
constexpr double kPlaceTolerance = 3e-6;
constexpr double kAxisTolerance = 6e-4;

constexpr const char* kTubeLine = "a tube line: <tube id> <node count> <edge count>";
constexpr const char* kNodeLine = "a node line: <node id> <x> <y> <z> <radius>";
constexpr const char* kEdgeLine =
    "an edge line: <edge id> <node id> <node id> <order> <radius> <cx> <cy> <cz> <qw> <qx> <qy> <qz> "
    "<length>";

class Parser {
 public:
  Parser(std::string_view text, const std::string& name) : lines_(text), name_(name) {}

  std::vector<PlacedTube> parse() {
    const std::uint32_t count = read_tube_count();
    std::vector<PlacedTube> tubes;
    for (std::uint32_t i = 0; i < count; ++i) tubes.push_back({read_tube(i + 1, count)});
    if (lines_.next_filled()) fail("the file's first line says {} tubes, but there is more", count);
    return tubes;
  }

 private:
  template <typename... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) const {
    throw_io_error("{}:{}: {}", name_, lines_.number(), fmt::format(format, std::forward<Args>(args)...));
  }

  std::uint32_t read_tube_count() {
    const std::optional<std::string_view> line = lines_.next();
    if (!line) throw_io_error("{}: the file is empty; expected the number of tubes", name_);
    const std::vector<std::string_view> words = words_of(*line);
    const std::optional<std::uint32_t> count = words.size() == 1 ? to_number<std::uint32_t>(words[0]) : std::nullopt;
    if (!count) fail("'{}' is not the number of tubes", excerpt(*line));
    return *count;
  }

  /// The words of the next line, which must be `count`.
  std::vector<std::string_view> read_line(std::size_t count, const char* expected) {
    const std::optional<std::string_view> line = lines_.next();
    if (!line) throw_io_error("{}: truncated after line {}: expected {}", name_, lines_.number(), expected);
    std::vector<std::string_view> words = words_of(*line);
    if (words.size() != count) fail("found {} values, expected {}", words.size(), expected);
    return words;
  }

  double read_number(std::string_view word, const char* what) const {
    const std::optional<double> value = to_number<double>(word);
    if (!value || !std::isfinite(*value)) fail("{} '{}' is not a number", what, excerpt(word));
    return *value;
  }

  std::uint32_t read_count(std::string_view word, const char* what) const {
    const std::optional<std::uint32_t> value = to_number<std::uint32_t>(word);
    if (!value) fail("{} '{}' is not a whole number from 0 to 4294967295", what, excerpt(word));
    return *value;
  }

  Vec3 read_point(const std::vector<std::string_view>& words, std::size_t first, const char* what) const {
    return {read_number(words[first], what), read_number(words[first + 1], what), read_number(words[first + 2], what)};
  }

  tube::Tube read_tube(std::uint32_t number, std::uint32_t count) {
    const std::optional<std::string_view> line = lines_.next();
    if (!line || words_of(*line).empty())
      throw_io_error("{}: truncated after line {}: the first line says {} tubes, but there are only {}", name_,
                     lines_.number(), count, number - 1);
    const std::vector<std::string_view> words = words_of(*line);
    if (words.size() != 3) fail("found {} values, expected {}", words.size(), kTubeLine);
    if (!tube_ids_.insert(words[0]).second) fail("the tube id {} stands twice", excerpt(words[0]));
    const std::uint32_t node_count = read_count(words[1], "node count");
    const std::uint32_t edge_count = read_count(words[2], "edge count");
    if (node_count == 0) fail("a tube needs a node");

    tube::Tube tube;
    node_index_.clear();
    node_radii_.clear();
    for (std::uint32_t i = 0; i < node_count; ++i) read_node(tube);
    for (std::uint32_t i = 0; i < edge_count; ++i) read_edge(tube);
    check_every_node_is_used(tube);
    check_node_radii(tube);
    return tube;
  }

  void read_node(tube::Tube& tube) {
    const std::vector<std::string_view> words = read_line(5, kNodeLine);
    if (!node_index_.emplace(words[0], static_cast<int>(tube.nodes.size())).second)
      fail("the node id {} stands twice in this tube", excerpt(words[0]));
    tube.nodes.push_back(read_point(words, 1, "coordinate"));
    const double radius = read_radius(words[4]);
    if (tube.radius == 0.0) tube.radius = radius;
    node_radii_.push_back(radius);
  }

  double read_radius(std::string_view word) const {
    const double radius = read_number(word, "radius");
    if (radius <= 0.0) fail("radius {} is not valid; valid: above 0 m", radius);
    return radius;
  }

  /// A node is as thick as the thickest edge there, as format_tubes_txt writes it.
  void check_node_radii(const tube::Tube& tube) const {
    const std::vector<double> radii = tube.node_radii();
    for (const auto& [id, index] : node_index_) {
      const auto i = static_cast<std::size_t>(index);
      if (std::abs(node_radii_[i] - radii[i]) > kPlaceTolerance)
        fail("node {} has the radius {}, the thickest of its edges {}", excerpt(id), node_radii_[i], radii[i]);
    }
  }

  void read_edge(tube::Tube& tube) {
    const std::vector<std::string_view> words = read_line(13, kEdgeLine);
    const std::optional<int> order = to_number<int>(words[3]);
    if (!order || *order < 1) fail("order '{}' is not a whole number from 1", excerpt(words[3]));
    tube::Cylinder cylinder = {find_node(words[1]), find_node(words[2]), *order - 1};
    const double radius = read_radius(words[4]);
    if (radius != tube.radius) cylinder.radius = radius;
    const Vec3 center = read_point(words, 5, "centre");
    const Quat rotation(read_number(words[8], "quaternion"), read_number(words[9], "quaternion"),
                        read_number(words[10], "quaternion"), read_number(words[11], "quaternion"));
    check_edge(tube, cylinder, center, rotation, read_number(words[12], "length"));
    tube.cylinders.push_back(cylinder);
  }

  int find_node(std::string_view id) const {
    const auto found = node_index_.find(id);
    if (found == node_index_.end()) fail("the edge names a node '{}' that this tube does not have", excerpt(id));
    return found->second;
  }

  void check_edge(const tube::Tube& tube, const tube::Cylinder& cylinder, const Vec3& center, const Quat& rotation,
                  double length) const {
    const Vec3& a = tube.nodes[static_cast<std::size_t>(cylinder.node_a)];
    const Vec3& b = tube.nodes[static_cast<std::size_t>(cylinder.node_b)];
    const double distance = (b - a).norm();
    if (!(distance > kPlaceTolerance)) fail("the edge's two nodes are at the same place");
    const double center_error = ((a + b) / 2.0 - center).lpNorm<Eigen::Infinity>();
    if (!(center_error <= kPlaceTolerance)) fail("the centre is {:.2e} m off the middle of its nodes", center_error);
    if (!(std::abs(length - distance) <= kPlaceTolerance))
      fail("length {} is not the distance of its nodes, {:.6f} m", length, distance);
    // Third column of the rotation matrix, written out so that a quaternion that is no unit one shows up.
    const double w = rotation.w(), x = rotation.x(), y = rotation.y(), z = rotation.z();
    const Vec3 axis(2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y));
    const double axis_error = (axis - (b - a) / distance).lpNorm<Eigen::Infinity>();
    if (!(axis_error <= kAxisTolerance)) fail("the axis is {:.2e} off the direction between its nodes", axis_error);
  }

  void check_every_node_is_used(const tube::Tube& tube) const {
    if (tube.nodes.size() == 1) return;  // a sphere
    const std::vector<int> degrees = tube.node_degrees();
    for (const auto& [id, index] : node_index_)
      if (degrees[static_cast<std::size_t>(index)] == 0) fail("no edge of this tube uses its node {}", excerpt(id));
  }

  LineScanner lines_;
  const std::string& name_;
  std::set<std::string_view> tube_ids_;
  std::map<std::string_view, int> node_index_;
  std::vector<double> node_radii_;
};

}  // namespace

std::vector<PlacedTube> parse_tubes_txt(std::string_view text, const std::string& name) {
  return Parser(text, name).parse();
}

std::vector<PlacedTube> read_tubes_txt(const std::string& path) { return parse_tubes_txt(read_file(path), path); }

std::string format_tubes_txt(const std::vector<PlacedTube>& tubes) {
  std::string text = fmt::format("{}\n", tubes.size());
  const auto out = std::back_inserter(text);
  for (std::size_t k = 0; k < tubes.size(); ++k) {
    const tube::Tube& tube = tubes[k].tube;
    fmt::format_to(out, "{} {} {}\n", k + 1, tube.nodes.size(), tube.cylinders.size());
    const std::vector<double> radii = tube.node_radii();
    for (int i = 0; i < static_cast<int>(tube.nodes.size()); ++i) {
      const Vec3 p = tubes[k].node_in_world(i);
      fmt::format_to(out, "{} {} {} {} {}\n", i + 1, p.x(), p.y(), p.z(), radii[static_cast<std::size_t>(i)]);
    }
    for (const tube::Cylinder& cylinder : tube.cylinders) {
      const Vec3 a = tubes[k].node_in_world(cylinder.node_a);
      const Vec3 b = tubes[k].node_in_world(cylinder.node_b);
      const Vec3 c = (a + b) / 2.0;
      const Quat q = Quat::FromTwoVectors(Vec3::UnitZ(), b - a);
      const int id_a = cylinder.node_a + 1, id_b = cylinder.node_b + 1;
      fmt::format_to(out, "e_{}_{} {} {} {} {} {} {} {} {} {} {} {} {}\n", id_a, id_b, id_a, id_b, cylinder.order + 1,
                     tube.radius_of(cylinder), c.x(), c.y(), c.z(), q.w(), q.x(), q.y(), q.z(), (b - a).norm());
    }
  }
  return text;
}

}  // namespace tubebin::scene
