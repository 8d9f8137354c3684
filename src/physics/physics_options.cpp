#include "tubebin/physics/drop_simulator.hpp"

namespace tubebin::physics {

void describe(Fields& fields, PhysicsOptions& o) {
  fields.number("gravity", o.gravity, {0.01, 100.0}, "m/s^2", "downward acceleration");
  fields.number("time_step", o.time_step, {1e-5, 0.05}, "s", "of the simulation; smaller is slower and more exact");
  fields.number("rest_time_step", o.rest_time_step, {1e-5, 0.05}, "s",
                "the same once all tubes have been slow for rest_window, while it is proven that nothing moves");
  fields.integer("solver_iterations", o.solver_iterations, {1, 10000}, "", "most sweeps over a step's contacts");
  fields.number("solver_tolerance", o.solver_tolerance, {0.0, 1.0}, "m/s",
                "a sweep that changes no contact's velocity by as much is a step's last");
  fields.number("solver_over_relaxation", o.solver_over_relaxation, {0.1, 1.9}, "", "Gauss-Seidel's SOR factor");
  fields.number("warm_start", o.warm_start, {0.0, 1.0}, "",
                "share of a lasting contact's force that the next step starts from; 0 starts from none");
  fields.number("contact_erp", o.contact_erp, {0.0, 1.0}, "",
                "share of an interpenetration that one step corrects (ODE's error reduction parameter)");
  fields.number("contact_cfm", o.contact_cfm, {0.0, 1.0}, "s/kg",
                "softness of a contact (ODE's constraint force mixing)");
  fields.number("contact_layer", o.contact_layer, {0.0, 0.01}, "m",
                "interpenetration that is left alone, so that resting contacts persist");
  fields.number("correcting_speed_max", o.correcting_speed_max, {0.0, 1000.0}, "m/s",
                "highest speed at which interpenetrating bodies are pushed apart");
  fields.number("friction_tube", o.friction_tube, {0.0, 1000.0}, "", "Coulomb friction, tube on tube");
  fields.number("friction_bin", o.friction_bin, {0.0, 1000.0}, "", "Coulomb friction, tube on bin");
  fields.number("rolling_resistance", o.rolling_resistance, {0.0, 1.0}, "m",
                "torque of a contact against rolling, divided by its normal force");
  fields.number("damping_linear", o.damping_linear, {0.0, 1.0}, "", "share of the linear velocity lost in a step");
  fields.number("damping_angular", o.damping_angular, {0.0, 1.0}, "", "share of the angular velocity lost in a step");
  fields.number("speed_max", o.speed_max, {0.01, 1000.0}, "m/s",
                "highest speed of a falling tube, as tubes that are poured from a low height");
  fields.choice(
      "spill", o.spill, {"reject", "guard", "redrop"},
      "reject: a drop that loses a tube over the walls fails; redrop: the tube is dropped again alone; guard: "
      "unseen guards stand on the walls while tubes fall, and what leaves the bin later is dropped again alone");
  fields.number("spawn_clearance", o.spawn_clearance, {0.0001, 1.0}, "m",
                "between spawned tubes, and between them and the bin's rim");
  fields.integer("spawn_tries", o.spawn_tries, {1, 10000}, "",
                 "free places looked at for each tube, of which the lowest is taken");
  fields.number("rest_speed", o.rest_speed, {1e-6, 10.0}, "m/s", "a tube slower than this may be at rest");
  fields.number("rest_turn_rate", o.rest_turn_rate, {1e-6, 100.0}, "rad/s",
                "a tube that turns slower than this may be at rest");
  fields.number("rest_window", o.rest_window, {0.02, 100.0}, "s",
                "how long all tubes stay below both at rest; longer than a tube takes from a standstill to rest_speed");
  fields.number("check_time", o.check_time, {0.0, 100.0}, "s",
                "how long the simulation runs on to prove that nothing moves");
  fields.number("drift_max", o.drift_max, {0.0, 1.0}, "m", "farthest that a tube's end may move in check_time");
  fields.number("penetration_max", o.penetration_max, {0.0, 1.0}, "m", "deepest interpenetration of a finished scene");
  fields.number("time_limit", o.time_limit, {0.001, 10000.0}, "s",
                "simulated time after which a drop counts as unsettled");
}

void check(const PhysicsOptions& options, const KeyPlaces& places, const std::string& prefix) {
  if (options.time_limit < options.rest_window + options.check_time)
    places.fail(prefix + ".time_limit", fmt::format("{} s leaves no time for rest_window = {} s and check_time = {} s",
                                                    options.time_limit, options.rest_window, options.check_time));
  if (options.penetration_max < options.contact_layer)
    places.fail(prefix + ".penetration_max",
                fmt::format("{} m is less than contact_layer = {} m, which every resting contact has",
                            options.penetration_max, options.contact_layer));
}

const char* to_string(DropFailure failure) {
  switch (failure) {
    case DropFailure::none:
      return "none";
    case DropFailure::spawn:
      return "spawn";
    case DropFailure::outside:
      return "outside";
    case DropFailure::unsettled:
      return "unsettled";
    case DropFailure::penetration:
      return "penetration";
    case DropFailure::drift:
      return "drift";
    case DropFailure::floating:
      return "floating";
  }
  return "unknown";
}

}  // namespace tubebin::physics
