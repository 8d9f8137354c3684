#include "tubebin/modeling/tube_shape.hpp"

#include <cmath>
#include <string_view>

#include "tubebin/core/error.hpp"
#include "tubebin/core/text_scan.hpp"

namespace tubebin::modeling {
namespace {

[[noreturn]] void refuse(const std::string& text, const std::string& problem) {
  throw_config_error(
      "--tube-shape {}: {}; valid: stretches in metres and the bends between them in degrees, as 0.12,90,0.05 or, with "
      "a rotated bend, 0.12,90,0.08,90@45,0.05",
      excerpt(text), problem);
}

double number_in(std::string_view word, const std::string& text) {
  const auto number = to_number<double>(word);
  if (!number) refuse(text, fmt::format("'{}' is no number", excerpt(word)));
  return *number;
}

void set_bend(std::string_view word, const std::string& text, TubeStretch& stretch) {
  const std::size_t at = word.find('@');
  stretch.bend_deg = number_in(word.substr(0, at), text);
  if (at != word.npos) stretch.rotation_deg = number_in(word.substr(at + 1), text);
}

/// A place on the centreline: where it leads, and toward where it bent last.
class Course {
 public:
  const Vec3& place() const { return place_; }
  void go(double length) { place_ += length * along_; }
  void rotate(double angle) { inward_ = Eigen::AngleAxisd(angle, along_) * inward_; }
  void turn(double angle) {
    const Eigen::AngleAxisd turned(angle, along_.cross(inward_));
    along_ = turned * along_;
    inward_ = turned * inward_;
  }

 private:
  Vec3 place_ = Vec3::Zero(), along_ = Vec3::UnitX(), inward_ = Vec3::UnitY();
};

}  // namespace

void describe(Fields& fields, TubeStretch& stretch) {
  fields.number("length", stretch.length, {1e-6, 10.0}, "m", "of the straight stretch, to where the bend begins");
  fields.number("bend_deg", stretch.bend_deg, {0.0, 180.0}, "degrees", "of the bend that follows; none after the last");
  fields.number("rotation_deg", stretch.rotation_deg, {-360.0, 360.0}, "degrees",
                "of that bend's plane about the stretch, right-handed, from the plane of the bend before");
}

void describe(Fields& fields, TubeShape& shape) {
  fields.list("stretches", shape.stretches, "in their order; two or more");
  fields.number("bend_radius", shape.bend_radius, {0.0, 10.0}, "m", "of the centreline in its bends; 0: corners");
}

void check(const TubeShape& shape, const KeyPlaces& places, const std::string& prefix) {
  const std::size_t count = shape.stretches.size();
  if (count < 2)
    places.fail(prefix + ".stretches", fmt::format("'{}' stretches do not bend; valid: two or more. Of straight tubes, "
                                                   "tube_length says all",
                                                   count));
  for (std::size_t k = 0; k < count; ++k) {
    const double bend = shape.stretches[k].bend_deg;
    const bool is_last = k + 1 == count;
    const bool is_valid = is_last ? bend == 0.0 : bend > 0.0 && (bend < 180.0 || shape.bend_radius > 0.0);
    if (!is_valid)
      places.fail(fmt::format("{}.stretches[{}].bend_deg", prefix, k),
                  fmt::format("'{}' is not valid; valid: {}", bend,
                              is_last ? "0 after the last stretch"
                                      : "above 0 and below 180 degrees, or 180 with a bend_radius above 0"));
  }
}

TubeShape parse_tube_shape(const std::string& text) {
  TubeShape shape;
  std::string_view rest = text;
  for (bool is_bend = false;; is_bend = !is_bend) {
    const std::size_t comma = rest.find(',');
    const std::string_view word = rest.substr(0, comma);
    if (is_bend) set_bend(word, text, shape.stretches.back());
    else shape.stretches.push_back({.length = number_in(word, text)});
    if (comma == rest.npos && is_bend) refuse(text, "it ends with a bend");
    if (comma == rest.npos) return shape;
    rest.remove_prefix(comma + 1);
  }
}

std::vector<Vec3> centerline_of(const TubeShape& shape) {
  constexpr double kChordAngle = radians(10.0);
  Course course;
  std::vector<Vec3> nodes = {course.place()};
  for (const TubeStretch& stretch : shape.stretches) {
    course.go(stretch.length);
    nodes.push_back(course.place());
    course.rotate(radians(stretch.rotation_deg));
    const double angle = radians(stretch.bend_deg);
    const double chords = shape.bend_radius > 0.0 ? std::ceil(angle / kChordAngle) : 0.0;
    for (double k = 0.0; k < chords; ++k) {
      const double half = angle / chords / 2.0;
      course.turn(half);
      course.go(2.0 * shape.bend_radius * std::sin(half));
      course.turn(half);
      nodes.push_back(course.place());
    }
    if (chords == 0.0) course.turn(angle);
  }
  return nodes;
}

}  // namespace tubebin::modeling
