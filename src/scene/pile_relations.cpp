#include "tubebin/scene/pile_relations.hpp"

#include <algorithm>

#include "scene/plan_overlap.hpp"

namespace tubebin::scene {
namespace {

/// A tube without its outermost kGrazing.
struct Core {
  std::vector<ConvexSolid> solids;
  Box bounds;
};

double eroded_of(double radius) { return std::min(kGrazing, 0.25 * radius); }

Core core_of(const PlacedTube& placed) {
  const tube::TubeSolids tube = placed.solids_in_world();
  Core core;
  for (const tube::SolidCylinder& cylinder : tube.cylinders) {
    const double eroded = eroded_of(cylinder.radius);
    const Vec3 axis = cylinder.b - cylinder.a, cut = std::min(eroded / axis.norm(), 0.25) * axis;
    core.solids.emplace_back(cylinder.is_free_a ? Vec3(cylinder.a + cut) : cylinder.a,
                             cylinder.is_free_b ? Vec3(cylinder.b - cut) : cylinder.b, cylinder.radius - eroded,
                             cylinder.is_free_a, cylinder.is_free_b);
  }
  // Joints lie within the rounded ends of their cylinders; a sphere alone has none.
  if (tube.cylinders.empty())
    for (const tube::JointSphere& ball : tube.joints)
      core.solids.emplace_back(ball.center, ball.radius - eroded_of(ball.radius));
  for (const ConvexSolid& solid : core.solids) core.bounds.extend(solid.bounds());
  return core;
}

bool overlap_in_plan(const Box& a, const Box& b) {
  return (a.min().head<2>().array() <= b.max().head<2>().array()).all() &&
         (b.min().head<2>().array() <= a.max().head<2>().array()).all();
}

struct Order {
  bool first_above = false;
  bool second_above = false;
};

Order order_of(const Core& first, const Core& second) {
  Order order;
  if (!overlap_in_plan(first.bounds, second.bounds)) return order;
  for (const ConvexSolid& a : first.solids) {
    const Box bounds = a.bounds();
    if (!overlap_in_plan(bounds, second.bounds)) continue;
    for (const ConvexSolid& b : second.solids) {
      if (!overlap_in_plan(bounds, b.bounds())) continue;
      const auto height = height_above(a, b);
      if (!height) continue;
      (*height > 0.0 ? order.second_above : order.first_above) = true;
      if (order.first_above && order.second_above) return order;
    }
  }
  return order;
}

/// reaches[i][j]: a chain of `above` leads from tube i + 1 down to tube j + 1 (Warshall 1962).
std::vector<std::vector<bool>> transitive_closure(std::size_t tube_count, const std::vector<Above>& above) {
  std::vector<std::vector<bool>> reaches(tube_count, std::vector<bool>(tube_count, false));
  for (const Above& pair : above) reaches[pair.upper - 1][pair.lower - 1] = true;
  for (std::size_t through = 0; through < tube_count; ++through)
    for (std::size_t from = 0; from < tube_count; ++from)
      if (reaches[from][through])
        for (std::size_t to = 0; to < tube_count; ++to)
          if (reaches[through][to]) reaches[from][to] = true;
  return reaches;
}

/// Walks a tube's cylinders, each once.
class PathWalker {
 public:
  explicit PathWalker(const tube::Tube& tube)
      : tube_(tube), degrees_(tube.node_degrees()), walked_(tube.cylinders.size()) {}

  bool is_inner(int node) const { return degrees_[static_cast<std::size_t>(node)] == 2; }
  bool is_alone(int node) const { return degrees_[static_cast<std::size_t>(node)] == 0; }

  /// The path that leaves `start` by its first cylinder not walked yet, to the next node that is no inner one (or back
  /// to `start`); `start` alone where all were walked.
  std::vector<int> walk(int start) {
    std::vector<int> path = {start};
    do {
      const int next = step_from(path.back());
      if (next < 0) break;
      path.push_back(next);
    } while (is_inner(path.back()) && path.back() != start);
    return path;
  }

 private:
  int step_from(int node) {
    for (std::size_t i = 0; i < walked_.size(); ++i) {
      const tube::Cylinder& cylinder = tube_.cylinders[i];
      if (walked_[i] || (cylinder.node_a != node && cylinder.node_b != node)) continue;
      walked_[i] = true;
      return cylinder.node_a == node ? cylinder.node_b : cylinder.node_a;
    }
    return -1;
  }

  const tube::Tube& tube_;
  std::vector<int> degrees_;
  std::vector<bool> walked_;
};

}  // namespace

bool PileRelations::is_liftable(std::uint32_t label) const {
  return std::ranges::none_of(above, [&](const Above& pair) { return pair.lower == label; });
}

std::vector<Above> find_above(const std::vector<PlacedTube>& tubes) {
  std::vector<Core> cores;
  for (const PlacedTube& tube : tubes) cores.push_back(core_of(tube));
  std::vector<Above> above;
  for (std::uint32_t i = 0; i < cores.size(); ++i)
    for (std::uint32_t j = i + 1; j < cores.size(); ++j) {
      const Order order = order_of(cores[i], cores[j]);
      if (order.first_above) above.push_back({i + 1, j + 1});
      if (order.second_above) above.push_back({j + 1, i + 1});
    }
  std::ranges::sort(above);
  return above;
}

bool has_above(const std::vector<PlacedTube>& tubes, std::uint32_t label) {
  const Core lower = core_of(tubes[label - 1]);
  for (std::uint32_t other = 1; other <= tubes.size(); ++other)
    if (other != label && order_of(core_of(tubes[other - 1]), lower).first_above) return true;
  return false;
}

std::vector<LabelGroup> entangled_groups(std::size_t tube_count, const std::vector<Above>& above) {
  const auto reaches = transitive_closure(tube_count, above);
  std::vector<bool> is_grouped(tube_count, false);
  std::vector<LabelGroup> groups;
  for (std::size_t i = 0; i < tube_count; ++i) {
    if (is_grouped[i] || !reaches[i][i]) continue;
    LabelGroup group;
    for (std::size_t j = i; j < tube_count; ++j)
      if (reaches[i][j] && reaches[j][i]) {
        is_grouped[j] = true;
        group.push_back(static_cast<std::uint32_t>(j + 1));
      }
    groups.push_back(std::move(group));
  }
  return groups;
}

std::vector<std::vector<int>> centerline_paths(const tube::Tube& tube) {
  PathWalker walker(tube);
  std::vector<std::vector<int>> paths;
  const auto walk_all_from = [&](int node) {
    for (std::vector<int> path = walker.walk(node); path.size() > 1; path = walker.walk(node))
      paths.push_back(std::move(path));
  };
  const int node_count = static_cast<int>(tube.nodes.size());
  for (int node = 0; node < node_count; ++node) {
    if (walker.is_alone(node)) paths.push_back({node});
    if (!walker.is_inner(node)) walk_all_from(node);
  }
  for (int node = 0; node < node_count; ++node) walk_all_from(node);  // rings have inner nodes alone
  return paths;
}

}  // namespace tubebin::scene
