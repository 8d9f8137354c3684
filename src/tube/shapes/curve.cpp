// A smooth tube: Algorithms 2 and 3 with rounded bends, sampled by short cylinders.
#include <algorithm>
#include <cmath>

#include "tube/shapes/shapes.hpp"

namespace tubebin::tube {
namespace {

enum class Form { arcs, spline };

double length_of(const std::vector<Vec3>& line) {
  double length = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) length += (line[i] - line[i - 1]).norm();
  return length;
}

void scale(std::vector<Vec3>& line, double factor) {
  for (Vec3& point : line) point *= factor;
}

/// Points of a polyline from its first to its last: `ends` apart at both ends, and between them at equal distances of at
/// most `step` (metres along the line).
std::vector<Vec3> resample(const std::vector<Vec3>& line, double ends, double step) {
  std::vector<double> along = {0.0};
  for (std::size_t i = 1; i < line.size(); ++i) along.push_back(along.back() + (line[i] - line[i - 1]).norm());
  const double between = along.back() - 2.0 * ends;
  const int count = static_cast<int>(std::ceil(between / step));
  std::vector<Vec3> points = {line.front()};
  std::size_t i = 1;
  for (int k = 0; k <= count; ++k) {
    const double wanted = ends + between * k / count;
    while (along[i] < wanted) ++i;
    points.push_back(line[i - 1] + (line[i] - line[i - 1]) * ((wanted - along[i - 1]) / (along[i] - along[i - 1])));
  }
  points.push_back(line.back());
  return points;
}

/// Consecutive circular arcs with common tangents, each bent by a random angle in a random plane; dense points.
std::vector<Vec3> arcs(const std::vector<double>& lengths, double bend_min, double bend_max, Random& random) {
  constexpr int kSteps = 2048;  // far shorter than any cylinder
  std::vector<Vec3> line = {Vec3::Zero()};
  const double phi = random.uniform(0.0, 2.0 * std::numbers::pi);
  Vec3 tangent = spherical(random.uniform(0.0, std::numbers::pi), phi);
  for (const double length : lengths) {
    const double turn = random.uniform(0.0, 2.0 * std::numbers::pi);
    const Vec3 inward = rotate_from_z_to(tangent, spherical(std::numbers::pi / 2.0, turn));
    const double bend = random.uniform(bend_min, bend_max);
    const Vec3 start = line.back();
    for (int k = 1; k <= kSteps; ++k) {
      // A chord of an arc is length * sinc(angle / 2) long and turned by half the arc's angle.
      const double half = 0.5 * bend * k / kSteps;
      const double chord = length * k / kSteps * (half > 0.0 ? std::sin(half) / half : 1.0);
      line.push_back(start + chord * (std::cos(half) * tangent + std::sin(half) * inward));
    }
    tangent = (std::cos(bend) * tangent + std::sin(bend) * inward).normalized();
  }
  return line;
}

/// The uniform cubic B-spline of control points, from the first to the last (which count three times); dense points.
std::vector<Vec3> cubic_spline(const std::vector<Vec3>& corners) {
  constexpr int kSteps = 2048;  // far shorter than any cylinder
  std::vector<Vec3> control = {corners.front(), corners.front()};
  control.insert(control.end(), corners.begin(), corners.end());
  control.insert(control.end(), 2, corners.back());
  std::vector<Vec3> line = {corners.front()};
  for (std::size_t i = 0; i + 3 < control.size(); ++i) {
    for (int k = 1; k <= kSteps; ++k) {
      const double t = static_cast<double>(k) / kSteps, s = 1.0 - t;
      line.push_back((s * s * s * control[i] + (3.0 * t * t * t - 6.0 * t * t + 4.0) * control[i + 1] +
                      (3.0 * s * s * s - 6.0 * s * s + 4.0) * control[i + 2] + t * t * t * control[i + 3]) /
                     6.0);
    }
  }
  return line;
}

/// Smallest radius of curvature of a path, metres, by the angle between cylinders and the distance of their middles.
double least_bend_radius(const Tube& tube) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 2; i < tube.nodes.size(); ++i) {
    const Vec3 before = tube.nodes[i - 1] - tube.nodes[i - 2], after = tube.nodes[i] - tube.nodes[i - 1];
    least = std::min(least, 0.5 * (before.norm() + after.norm()) / angle_between(before, after));
  }
  return least;
}

/// Radii where sections meet, and between them a smooth step (3 t^2 - 2 t^3), level at both of its ends.
double radius_along(const std::vector<double>& radii, const std::vector<double>& lengths, double along) {
  std::size_t section = 0;
  while (section + 1 < lengths.size() && along > lengths[section]) along -= lengths[section++];
  const double t = std::clamp(along / lengths[section], 0.0, 1.0);
  return radii[section] + (radii[section + 1] - radii[section]) * t * t * (3.0 - 2.0 * t);
}

class Curve : public CopiedShape<Curve> {
 public:
  void describe(Fields& fields, TubeOptions&) override {
    fields.choice("form", form_, {"arcs", "spline"},
                  "arcs: circular arcs with common tangents; spline: a cubic B-spline of Algorithm 3's corners");
    fields.number("length", length_, {0.001, 100.0}, "m", "along the tube, the sum of its cylinders");
    fields.number("section_length_min", section_length_min_, {0.0001, 100.0}, "m",
                  "shortest arc, or shortest side of the spline's corners");
    fields.integer("section_count_min", section_count_min_, {1, 10000}, "", "fewest arcs or sides");
    fields.integer("section_count_max", section_count_max_, {1, 10000}, "", "most arcs or sides");
    fields.number("bend_angle_min_deg", bend_angle_min_deg_, {0.0, 180.0}, "degrees",
                  "smallest angle of an arc, or between sides");
    fields.number("bend_angle_max_deg", bend_angle_max_deg_, {0.0, 180.0}, "degrees",
                  "largest angle of an arc, or between sides");
    fields.number("radius_variation", radius_variation_, {0.0, 0.9}, "",
                  "how much thicker and thinner than radius the tube may be along its length, as a part of radius");
    fields.number("cylinder_length_max", cylinder_length_max_, {0.0001, 1.0}, "m",
                  "longest cylinder; shorter ones follow the curve more closely");
  }

  void check(const TubeOptions& options, const KeyPlaces& places, const std::string& prefix) const override {
    if (section_count_max_ < section_count_min_)
      places.fail(prefix + ".section_count_max",
                  fmt::format("{} is less than section_count_min = {}", section_count_max_, section_count_min_));
    if (bend_angle_max_deg_ < bend_angle_min_deg_)
      places.fail(prefix + ".bend_angle_max_deg",
                  fmt::format("{} is less than bend_angle_min_deg = {}", bend_angle_max_deg_, bend_angle_min_deg_));
    const double least_length = section_count_max_ * section_length_min_;
    if (least_length > length_ * (1.0 + 1e-12))
      places.fail(prefix + ".section_length_min",
                  fmt::format("{} sections of at least {} m make {} m, more than the tube's length = {} m",
                              section_count_max_, section_length_min_, least_length, length_));
    if (3.0 * end_length(options) > length_)
      places.fail(prefix + ".length", fmt::format("{} m is less than three times the {} m of a straight end", length_,
                                                  end_length(options)));
    if (tightest_bend() < thickest(options))
      places.fail(prefix + ".bend_angle_max_deg",
                  fmt::format("{} degrees over {} m bend with a radius of {:.4f} m, less than the tube's radius = {} m",
                              bend_angle_max_deg_, section_length_min_, tightest_bend(), thickest(options)));
    if (const double thinnest = options.radius * (1.0 - radius_variation_);
        radius_variation_ > 0.0 && options.wall_thickness >= thinnest)
      places.fail(prefix + ".radius_variation",
                  fmt::format("{} makes the tube as thin as {} m, which leaves no bore in a wall of {} m",
                              radius_variation_, thinnest, options.wall_thickness));
  }

  Tube generate(const TubeOptions& options, Random& random) const override {
    Tube tube = draw(options, random);
    while (least_bend_radius(tube) < thickest(options)) tube = draw(options, random);
    return tube;
  }

 private:
  Tube draw(const TubeOptions& options, Random& random) const {
    const int section_count = random.integer(section_count_min_, section_count_max_);
    const std::vector<double> lengths = generate_lengths(section_count, length_, section_length_min_, random);
    const double bend_min = radians(bend_angle_min_deg_), bend_max = radians(bend_angle_max_deg_);
    std::vector<Vec3> line = form_ == Form::arcs
                                 ? arcs(lengths, bend_min, bend_max, random)
                                 : cubic_spline(generate_endpoints(lengths, bend_min, bend_max, random));
    scale(line, length_ / length_of(line));  // splines cut corners
    Tube tube;
    tube.nodes = {Vec3::Zero()};
    append_path(0, resample(line, end_length(options), cylinder_length_max_), tube);
    scale(tube.nodes, length_ / tube.length());  // chords are shorter than arcs
    if (radius_variation_ > 0.0) vary_radius(options, lengths, random, tube);
    return tube;
  }

  /// Each cylinder gets the radius at its middle.
  void vary_radius(const TubeOptions& options, const std::vector<double>& lengths, Random& random, Tube& tube) const {
    std::vector<double> radii;
    for (std::size_t i = 0; i <= lengths.size(); ++i)
      radii.push_back(options.radius * random.uniform(1.0 - radius_variation_, 1.0 + radius_variation_));
    double along = 0.0;
    for (Cylinder& cylinder : tube.cylinders) {
      const double length = tube.length(cylinder);
      cylinder.radius = radius_along(radii, lengths, along + 0.5 * length);
      along += length;
    }
  }

  double thickest(const TubeOptions& options) const { return options.radius * (1.0 + radius_variation_); }

  /// A joint's sphere would stick out of a flat end that is nearer than the tube's radius (and a little for the bend).
  double end_length(const TubeOptions& options) const {
    return std::max(1.05 * thickest(options), cylinder_length_max_);
  }

  /// The radius of curvature, metres, of the tightest arc, or where a B-spline's shortest sides meet at the largest
  /// angle. Beside longer sides, near its ends, a spline may bend more tightly.
  double tightest_bend() const {
    const double bend = radians(bend_angle_max_deg_);
    if (bend == 0.0) return std::numeric_limits<double>::infinity();
    if (form_ == Form::arcs) return section_length_min_ / bend;
    const double cosine = std::cos(bend / 2.0);
    return section_length_min_ * cosine * cosine / (2.0 * std::sin(bend / 2.0));
  }

  Form form_ = Form::arcs;
  double length_ = 0.5;               ///< metres
  double section_length_min_ = 0.05;  ///< metres
  int section_count_min_ = 3;
  int section_count_max_ = 6;
  double bend_angle_min_deg_ = 10.0;
  double bend_angle_max_deg_ = 60.0;
  double radius_variation_ = 0.0;       ///< of the radius
  double cylinder_length_max_ = 0.005;  ///< metres
};

}  // namespace

std::unique_ptr<Shape> make_curve() { return std::make_unique<Curve>(); }

}  // namespace tubebin::tube
