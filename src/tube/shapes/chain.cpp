// The paper's tube: one path of cylinders (Section 3).
#include "tube/shapes/shapes.hpp"

namespace tubebin::tube {
namespace {

class Chain : public CopiedShape<Chain> {
 public:
  void describe(Fields& fields, TubeOptions& options) override {
    tube::describe(fields, static_cast<PathOptions&>(options));
  }
  void check(const TubeOptions& options, const KeyPlaces& places, const std::string& prefix) const override {
    tube::check(static_cast<const PathOptions&>(options), places, prefix);
    check_open_ends(options, options.radius, options.wall_thickness, places, prefix);
  }
  Tube generate(const TubeOptions& options, Random& random) const override {
    Tube tube;
    tube.nodes = {Vec3::Zero()};
    append_path(0, generate_path(options, random), tube);
    return tube;
  }
};

}  // namespace

std::unique_ptr<Shape> make_chain() { return std::make_unique<Chain>(); }

}  // namespace tubebin::tube
