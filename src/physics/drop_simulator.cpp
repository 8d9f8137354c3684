#include "tubebin/physics/drop_simulator.hpp"

#include "physics/settling.hpp"
#include "physics/spawn.hpp"

namespace tubebin::physics {

DropResult drop_tubes(const std::vector<tube::Tube>& tubes, const scene::Bin& bin, const PhysicsOptions& options,
                      std::uint64_t seed) {
  Random random(seed);
  const auto spawned = spawn(tubes, bin, options, random);
  if (spawned) return settle(RigidWorld(*spawned, bin, options), {}, bin, options, random);
  DropResult result;
  result.failure = DropFailure::spawn;
  result.detail = "a tube fits between the walls in no orientation";
  return result;
}

}  // namespace tubebin::physics
