#include "tubebin/scene/place_surroundings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/footprint.hpp"

namespace tubebin::scene {
namespace {

constexpr int kPlacesTried = 1000;

/// What a body takes up: its footprint from bottom to top.
struct Prism {
  Footprint footprint;
  double bottom = 0.0;
  double top = 0.0;
};

bool are_near(const Prism& a, const Prism& b, double clearance) {
  return a.bottom <= b.top + clearance && b.bottom <= a.top + clearance &&
         distance(a.footprint, b.footprint) <= clearance;
}

Prism prism_of(const StandingBox& box, const Bin&) {
  return {.footprint = {.center = box.position.head<2>(),
                        .half_size = box.size.head<2>() / 2.0,
                        .yaw = radians(box.yaw_deg)},
          .bottom = box.position.z(),
          .top = box.position.z() + box.size.z()};
}

Prism prism_of(const StandingCylinder& cylinder, const Bin&) {
  return {.footprint = {.center = cylinder.position.head<2>(), .radius = cylinder.radius},
          .bottom = cylinder.position.z(),
          .top = cylinder.position.z() + cylinder.height};
}

Prism prism_of(const StandingBin& bin, const Bin& form) {
  const Box bounds = bin_bounds(form);
  return {.footprint = {.center = bin.position.head<2>(),
                        .half_size = bounds.sizes().head<2>() / 2.0,
                        .yaw = radians(bin.yaw_deg)},
          .bottom = bin.position.z() + bounds.min().z(),
          .top = bin.position.z() + bounds.max().z()};
}

/// A cylinder with balls around its ends holds it.
Prism prism_around(const Vec3& a, const Vec3& b, double radius) {
  const Vec3 along = b - a;
  return {.footprint = {.center = (a + b).head<2>() / 2.0,
                        .half_size = {along.head<2>().norm() / 2.0, 0.0},
                        .yaw = std::atan2(along.y(), along.x()),
                        .radius = radius},
          .bottom = std::min(a.z(), b.z()) - radius,
          .top = std::max(a.z(), b.z()) + radius};
}

std::vector<Prism> prisms_of(const PlacedTube& tube) {
  std::vector<Prism> prisms;
  const tube::TubeSolids solids = tube.solids_in_world();
  for (const tube::SolidCylinder& cylinder : solids.cylinders)
    prisms.push_back(prism_around(cylinder.a, cylinder.b, cylinder.radius));
  for (const tube::JointSphere& joint : solids.joints)
    prisms.push_back(prism_around(joint.center, joint.center, joint.radius));
  return prisms;
}

/// Draws places for one object after the other, until one finds none.
class Placer {
 public:
  Placer(const StandingBox& table, const Bin& bin, double clearance, Random& random)
      : table_(table), bin_(bin), clearance_(clearance), random_(random) {}

  void keep_clear_of(const Prism& prism) { taken_.push_back(prism); }

  template <typename Object>
  void add(Object object, const char* name, std::vector<Object>& to) {
    if (!problem_.empty()) return;
    for (int i = 0; i < kPlacesTried; ++i) {
      object.position.x() = random_.uniform(-table_.size.x() / 2.0, table_.size.x() / 2.0);
      object.position.y() = random_.uniform(-table_.size.y() / 2.0, table_.size.y() / 2.0);
      if constexpr (requires { object.yaw_deg; }) object.yaw_deg = random_.uniform(0.0, 360.0);
      const Prism prism = prism_of(object, bin_);
      if (!is_free(prism)) continue;
      keep_clear_of(prism);
      return to.push_back(object);
    }
    problem_ = fmt::format("{} {} found no free place on the table in {} tries", name, to.size() + 1, kPlacesTried);
  }

  const std::string& problem() const { return problem_; }

 private:
  bool is_free(const Prism& prism) const {
    const auto is_on_table = [&](const Eigen::Vector2d& corner) {
      return ((corner.cwiseAbs().array() + prism.footprint.radius) <= table_.size.head<2>().array() / 2.0).all();
    };
    return std::ranges::all_of(prism.footprint.corners(), is_on_table) &&
           std::ranges::none_of(taken_, [&](const Prism& taken) { return are_near(prism, taken, clearance_); });
  }

  const StandingBox& table_;
  const Bin& bin_;
  double clearance_;
  Random& random_;
  std::vector<Prism> taken_;
  std::string problem_;
};

StandingBox random_box(const SurroundingsOptions& options, const Vec3& position, Random& random) {
  StandingBox box{.position = position};
  for (double& edge : box.size) edge = random.uniform(options.box_size_min, options.box_size_max);
  return box;
}

StandingCylinder random_cylinder(const SurroundingsOptions& options, const Vec3& position, Random& random) {
  StandingCylinder cylinder{.position = position};
  cylinder.radius = random.uniform(options.cylinder_radius_min, options.cylinder_radius_max);
  cylinder.height = random.uniform(options.cylinder_height_min, options.cylinder_height_max);
  return cylinder;
}

}  // namespace

StandingBox table_of(const SurroundingsOptions& options, const Bin& bin) {
  return {.position = {0.0, 0.0, bin_bounds(bin).min().z() - options.table_thickness},
          .size = {options.table_length, options.table_width, options.table_thickness}};
}

PlacedSurroundings place_surroundings(const SurroundingsOptions& options, const Bin& bin,
                                      const std::vector<PlacedTube>& tubes, const std::vector<Scanner>& scanners,
                                      Random& random) {
  if (options.table_length == 0.0) return {};
  Surroundings placed{.table = table_of(options, bin), .boxes = {}, .cylinders = {}, .bins = {}};
  Placer placer(placed.table, bin, options.clearance, random);
  placer.keep_clear_of(prism_of(StandingBin{}, bin));
  for (const PlacedTube& tube : tubes)
    for (const Prism& prism : prisms_of(tube)) placer.keep_clear_of(prism);
  for (const Scanner& scanner : scanners) placer.keep_clear_of(prism_around(scanner.position, scanner.position, 0.0));

  const Vec3 on_table(0.0, 0.0, bin_bounds(bin).min().z());
  for (int i = 0; i < options.bins; ++i) placer.add(StandingBin{}, "further bin", placed.bins);
  for (int i = random.integer(options.box_count_min, options.box_count_max); i > 0; --i)
    placer.add(random_box(options, on_table, random), "box", placed.boxes);
  for (int i = random.integer(options.cylinder_count_min, options.cylinder_count_max); i > 0; --i)
    placer.add(random_cylinder(options, on_table, random), "cylinder", placed.cylinders);
  if (!placer.problem().empty()) return {.surroundings = {}, .problem = placer.problem()};
  return {.surroundings = std::move(placed), .problem = ""};
}

std::string find_touching_tube(const Surroundings& surroundings, const Bin& bin, const std::vector<PlacedTube>& tubes) {
  const auto find = [&](const auto& objects, const char* name) -> std::string {
    for (std::size_t i = 0; i < objects.size(); ++i)
      for (std::size_t k = 0; k < tubes.size(); ++k)
        for (const Prism& prism : prisms_of(tubes[k]))
          if (are_near(prism, prism_of(objects[i], bin), 0.0))
            return fmt::format("tube {} reaches {} {} beside the bin", k + 1, name, i + 1);
    return "";
  };
  for (const std::string& found : {find(surroundings.boxes, "box"), find(surroundings.cylinders, "cylinder"),
                                   find(surroundings.bins, "further bin")})
    if (!found.empty()) return found;
  return "";
}

}  // namespace tubebin::scene
