// A tree of paths, as the published set C has it: Algorithms 2 and 3 make each path, which begins at a node where an
// earlier path begins or ends.
#include <algorithm>
#include <cmath>
#include <map>

#include "tube/shapes/shapes.hpp"

namespace tubebin::tube {
namespace {

/// One path of the tree, between two numbered nodes.
struct Branch : PathOptions {
  int from = 1;
  int to = 2;
};

void describe(Fields& fields, Branch& branch) {
  fields.integer("from", branch.from, {1, 10000}, "", "node where the path begins; an earlier path has it");
  fields.integer("to", branch.to, {1, 10000}, "", "node where the path ends; no earlier path has it");
  describe(fields, static_cast<PathOptions&>(branch));
}

/// Whether a further arm always finds a direction: the caps of `angle` around the others leave a tenth of the sphere.
bool leaves_room(int arms, double angle) { return (arms - 1) * (1.0 - std::cos(angle)) / 2.0 <= 0.9; }

class Branching : public CopiedShape<Branching> {
 public:
  void describe(Fields& fields, TubeOptions&) override {
    fields.number("junction_angle_min_deg", junction_angle_min_deg_, {0.0, 180.0}, "degrees",
                  "smallest angle between two paths where they meet; the published set has no such limit");
    fields.list("paths", paths_, "the tree's paths, each grown from a node that an earlier one has");
  }

  void check(const TubeOptions& options, const KeyPlaces& places, const std::string& prefix) const override {
    if (paths_.empty()) places.fail(prefix + ".paths", "missing; a branching tube is a list of paths");
    std::map<int, int> arms;  // of each node
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      const Branch& path = paths_[i];
      const std::string place = fmt::format("{}.paths[{}]", prefix, i);
      tube::check(static_cast<const PathOptions&>(path), places, place);
      check_open_ends(path, options.radius, options.wall_thickness, places, place);
      if (i > 0 && !arms.contains(path.from))
        places.fail(place + ".from", fmt::format("no earlier path has the node {}", path.from));
      if (path.to == path.from || arms.contains(path.to))
        places.fail(place + ".to", fmt::format("the node {} is in the tree already; a tree has no loops", path.to));
      ++arms[path.from];
      ++arms[path.to];
    }
    const auto busiest = std::ranges::max_element(arms, {}, [](const auto& node) { return node.second; });
    if (!leaves_room(busiest->second, radians(junction_angle_min_deg_)))
      places.fail(prefix + ".junction_angle_min_deg",
                  fmt::format("{} degrees leave no room for the {} paths that meet at node {}", junction_angle_min_deg_,
                              busiest->second, busiest->first));
  }

  Tube generate(const TubeOptions&, Random& random) const override {
    Tube tube;
    tube.nodes = {Vec3::Zero()};
    std::map<int, int> index_of_node = {{paths_.front().from, 0}};
    for (const Branch& path : paths_) {
      const int start = index_of_node.at(path.from);
      const std::vector<Vec3> arms = tube.directions_from(start);
      std::vector<Vec3> nodes = generate_path(path, random);
      while (is_crowded(nodes[1].normalized(), arms)) nodes = generate_path(path, random);
      for (Vec3& node : nodes) node += tube.nodes[static_cast<std::size_t>(start)];
      append_path(start, nodes, tube);
      index_of_node[path.to] = static_cast<int>(tube.nodes.size()) - 1;
    }
    return tube;
  }

 private:
  bool is_crowded(const Vec3& direction, const std::vector<Vec3>& arms) const {
    const double cosine = std::cos(radians(junction_angle_min_deg_));
    return std::ranges::any_of(arms, [&](const Vec3& arm) { return arm.dot(direction) > cosine; });
  }

  double junction_angle_min_deg_ = 0.0;
  std::vector<Branch> paths_;
};

}  // namespace

std::unique_ptr<Shape> make_branching() { return std::make_unique<Branching>(); }

}  // namespace tubebin::tube
