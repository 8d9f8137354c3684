// A ball of the tube's radius: one node without cylinders.
#include "tube/shapes/shapes.hpp"

namespace tubebin::tube {
namespace {

class Sphere : public CopiedShape<Sphere> {
 public:
  void describe(Fields&, TubeOptions&) override {}
  void check(const TubeOptions&, const KeyPlaces&, const std::string&) const override {}
  Tube generate(const TubeOptions&, Random&) const override {
    Tube tube;
    tube.nodes = {Vec3::Zero()};
    return tube;
  }
};

}  // namespace

std::unique_ptr<Shape> make_sphere() { return std::make_unique<Sphere>(); }

}  // namespace tubebin::tube
