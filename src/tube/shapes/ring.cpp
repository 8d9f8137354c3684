// A closed tube around a hole: a regular polygon of cylinders, in a random orientation.
#include <cmath>

#include "tube/shapes/shapes.hpp"

namespace tubebin::tube {
namespace {

class Ring : public CopiedShape<Ring> {
 public:
  void describe(Fields& fields, TubeOptions&) override {
    fields.number("diameter_min", diameter_min_, {0.001, 100.0}, "m",
                  "smallest diameter of the circle on which the centreline's corners lie");
    fields.number("diameter_max", diameter_max_, {0.001, 100.0}, "m", "largest diameter of that circle");
    fields.integer("cylinder_count", cylinder_count_, {3, 1000}, "", "cylinders of a ring; more make it rounder");
  }

  void check(const TubeOptions& options, const KeyPlaces& places, const std::string& prefix) const override {
    if (diameter_max_ < diameter_min_)
      places.fail(prefix + ".diameter_max",
                  fmt::format("{} is less than diameter_min = {}", diameter_max_, diameter_min_));
    const double hole = diameter_min_ * std::cos(std::numbers::pi / cylinder_count_) - 2.0 * options.radius;
    if (hole <= 0.0)
      places.fail(prefix + ".diameter_min", fmt::format("{} m leaves no hole between {} cylinders of radius {} m",
                                                        diameter_min_, cylinder_count_, options.radius));
  }

  Tube generate(const TubeOptions&, Random& random) const override {
    const double radius = 0.5 * random.uniform(diameter_min_, diameter_max_);
    const Quat rotation = random.rotation();
    Tube tube;
    for (int i = 0; i < cylinder_count_; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / cylinder_count_;
      tube.nodes.push_back(rotation * Vec3(radius * std::cos(angle), radius * std::sin(angle), 0.0));
      tube.cylinders.push_back({.node_a = i, .node_b = (i + 1) % cylinder_count_, .order = i});
    }
    return tube;
  }

 private:
  double diameter_min_ = 0.10;  ///< metres
  double diameter_max_ = 0.15;  ///< metres
  int cylinder_count_ = 36;
};

}  // namespace

std::unique_ptr<Shape> make_ring() { return std::make_unique<Ring>(); }

}  // namespace tubebin::tube
