#include "tubebin/tube/tube_path.hpp"

#include <cmath>

namespace tubebin::tube {

void describe(Fields& fields, PathOptions& options) {
  fields.number("length", options.length, {0.001, 100.0}, "m", "length l, the sum of a tube's cylinders");
  fields.number("cylinder_length_min", options.cylinder_length_min, {0.0001, 100.0}, "m",
                "shortest cylinder cl_min; longer ones make fewer, straighter stretches");
  fields.integer("cylinder_count_min", options.cylinder_count_min, {1, 10000}, "", "fewest cylinders cn_min in a tube");
  fields.integer("cylinder_count_max", options.cylinder_count_max, {1, 10000}, "", "most cylinders cn_max in a tube");
  fields.number("bend_angle_min_deg", options.bend_angle_min_deg, {0.0, 180.0}, "degrees",
                "smallest bend theta_min between consecutive cylinders");
  fields.number("bend_angle_max_deg", options.bend_angle_max_deg, {0.0, 180.0}, "degrees",
                "largest bend theta_max between consecutive cylinders");
}

void check(const PathOptions& options, const KeyPlaces& places, const std::string& prefix) {
  if (options.cylinder_count_max < options.cylinder_count_min)
    places.fail(prefix + ".cylinder_count_max", fmt::format("{} is less than cylinder_count_min = {}",
                                                            options.cylinder_count_max, options.cylinder_count_min));
  if (options.bend_angle_max_deg < options.bend_angle_min_deg)
    places.fail(prefix + ".bend_angle_max_deg", fmt::format("{} is less than bend_angle_min_deg = {}",
                                                            options.bend_angle_max_deg, options.bend_angle_min_deg));
  const double least_length = options.cylinder_count_max * options.cylinder_length_min;
  // Decimal fractions of the file may multiply to a rounding error more: 5 x 0.02 = 0.1 is possible.
  if (least_length > options.length * (1.0 + 1e-12))
    places.fail(prefix + ".cylinder_length_min",
                fmt::format("{} cylinders of at least {} m make {} m, more than the tube's length = {} m; lower "
                            "cylinder_count_max or cylinder_length_min",
                            options.cylinder_count_max, options.cylinder_length_min, least_length, options.length));
}

void check_open_ends(const PathOptions& options, double radius, double wall_thickness, const KeyPlaces& places,
                     const std::string& prefix) {
  if (wall_thickness > 0.0 && options.cylinder_count_max > 1 && options.cylinder_length_min < radius)
    places.fail(prefix + ".cylinder_length_min",
                fmt::format("{} m is less than the radius = {} m of a hollow tube: its joints would close its ends",
                            options.cylinder_length_min, radius));
}

std::vector<double> generate_lengths(int count, double length, double cylinder_length_min, Random& random) {
  std::vector<double> lengths;
  double remaining = length;
  for (int i = 0; i <= count - 2; ++i) {
    const double longest = remaining - (count - 1 - i) * cylinder_length_min;
    lengths.push_back(random.uniform(cylinder_length_min, std::max(longest, cylinder_length_min)));
    remaining -= lengths.back();
  }
  lengths.push_back(remaining);
  return lengths;
}

/// The paper prints the dot product where the angle, its arc cosine, is meant. Along -z the cross product vanishes and
/// any horizontal axis serves.
Vec3 rotate_from_z_to(const Vec3& direction, const Vec3& vector) {
  const Vec3 cross = Vec3::UnitZ().cross(direction);
  const double sine = cross.norm();
  const double angle = std::atan2(sine, direction.z());  // acos of the dot product, exact near 0 and pi
  const Vec3 axis = sine > 0.0 ? Vec3(cross / sine) : Vec3::UnitX();
  return Eigen::AngleAxisd(angle, axis) * vector;
}

Vec3 spherical(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

std::vector<Vec3> generate_endpoints(const std::vector<double>& lengths, double bend_angle_min, double bend_angle_max,
                                     Random& random) {
  std::vector<Vec3> endpoints = {Vec3::Zero()};
  Vec3 previous_direction = Vec3::UnitZ();
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    const double phi = random.uniform(0.0, 2.0 * std::numbers::pi);
    const double theta =
        i == 0 ? random.uniform(0.0, std::numbers::pi) : random.uniform(bend_angle_min, bend_angle_max);
    const Vec3 direction = rotate_from_z_to(previous_direction, spherical(theta, phi));
    endpoints.push_back(endpoints.back() + lengths[i] * direction);
    previous_direction = direction;
  }
  return endpoints;
}

std::vector<Vec3> generate_path(const PathOptions& options, Random& random) {
  const int cylinder_count = random.integer(options.cylinder_count_min, options.cylinder_count_max);
  const std::vector<double> lengths =
      generate_lengths(cylinder_count, options.length, options.cylinder_length_min, random);
  return generate_endpoints(lengths, radians(options.bend_angle_min_deg), radians(options.bend_angle_max_deg), random);
}

void append_path(int start, const std::vector<Vec3>& nodes, Tube& tube) {
  int last = start;
  for (int i = 1; i < static_cast<int>(nodes.size()); ++i) {
    const int next = static_cast<int>(tube.nodes.size());
    tube.nodes.push_back(nodes[static_cast<std::size_t>(i)]);
    tube.cylinders.push_back({.node_a = last, .node_b = next, .order = i - 1});
    last = next;
  }
}

}  // namespace tubebin::tube
