#include "physics/contact_solver.hpp"

#include <algorithm>
#include <cmath>

namespace tubebin::physics {
namespace {

/// One direction in which a contact bears a force: a row of the Jacobian, and what a unit impulse along it does.
struct Row {
  Vec3 direction;
  Vec3 arm_first, arm_second;    ///< metres: the direction's moment about the centres of mass
  Vec3 turn_first, turn_second;  ///< rad/s by a unit impulse
  double response = 0.0;         ///< 1/kg: relative velocity by a unit impulse
  double impulse = 0.0;          ///< N s

  void set(const Vec3& along, const Vec3& at, const SolverBody& first, const SolverBody& second) {
    direction = along;
    arm_first = (at - first.center).cross(along);
    arm_second = (at - second.center).cross(along);
    turn_first = first.inverse_inertia * arm_first;
    turn_second = second.inverse_inertia * arm_second;
    response = first.inverse_mass + second.inverse_mass + arm_first.dot(turn_first) + arm_second.dot(turn_second);
  }

  /// m/s, at which the bodies move apart along the direction.
  double velocity(const SolverBody& first, const SolverBody& second) const {
    return direction.dot(second.velocity - first.velocity) + arm_second.dot(second.turn_velocity) -
           arm_first.dot(first.turn_velocity);
  }

  /// Returns by how much the relative velocity changed.
  double change_to(double new_impulse, SolverBody& first, SolverBody& second) {
    const double change = new_impulse - impulse;
    impulse = new_impulse;
    first.velocity -= (change * first.inverse_mass) * direction;
    second.velocity += (change * second.inverse_mass) * direction;
    first.turn_velocity -= change * turn_first;
    second.turn_velocity += change * turn_second;
    return std::abs(change) * response;
  }
};

/// At which the surfaces are to part at least (m/s): what interpenetrates is corrected by its share, what is apart may
/// close its gap within the step.
double separation_speed(const PhysicsOptions& options, double time_step, double depth) {
  if (depth < 0.0) return depth / time_step;
  const double excess = std::max(0.0, depth - options.contact_layer);
  return std::min(options.correcting_speed_max, options.contact_erp * excess / time_step);
}

/// A contact's force as a normal and two tangential impulses, and its resistance to rolling.
class Constraint {
 public:
  Constraint(const PhysicsOptions& options, double time_step, const StepContact& contact,
             std::vector<SolverBody>& bodies)
      : first_(bodies[std::min(contact.first, bodies.size() - 1)]),
        second_(bodies[contact.second]),
        time_step_(time_step),
        over_relaxation_(options.solver_over_relaxation),
        friction_(contact.friction),
        rolling_arm_(options.rolling_resistance),
        softness_(options.contact_cfm / time_step) {
    const Vec3& normal = contact.touch.normal;
    const Vec3 side = normal.unitOrthogonal();
    normal_.set(normal, contact.touch.position, first_, second_);
    sides_[0].set(side, contact.touch.position, first_, second_);
    sides_[1].set(normal.cross(side), contact.touch.position, first_, second_);
    turn_inverse_ = (first_.inverse_inertia + second_.inverse_inertia).inverse();
    separation_speed_ = separation_speed(options, time_step, contact.touch.depth);
    start_from(contact);
  }

  /// One Gauss-Seidel step; by how much the contact's relative velocity changed, m/s. Changes of rolling show in the
  /// tangential velocities of the next iteration.
  double iterate() {
    resist_rolling();
    return std::max(resist_sliding(), resist_approach());
  }

  void store(StepContact& contact) const {
    contact.force = (normal_.impulse * normal_.direction + sides_[0].impulse * sides_[0].direction +
                     sides_[1].impulse * sides_[1].direction) /
                    time_step_;
    contact.resistance = rolling_impulse_ / time_step_;
  }

 private:
  void start_from(const StepContact& contact) {
    const Vec3 impulse = time_step_ * contact.force;
    normal_.change_to(std::max(0.0, impulse.dot(normal_.direction)), first_, second_);
    for (Row& side : sides_) side.change_to(impulse.dot(side.direction), first_, second_);
    change_rolling_to(time_step_ * contact.resistance);
  }

  double resist_approach() {
    const double lacking = separation_speed_ - normal_.velocity(first_, second_) - softness_ * normal_.impulse;
    const double impulse = normal_.impulse + over_relaxation_ * lacking / (normal_.response + softness_);
    return normal_.change_to(std::max(0.0, impulse), first_, second_);
  }

  double resist_sliding() {
    Eigen::Vector2d wanted;
    for (int i = 0; i < 2; ++i)
      wanted[i] = sides_[i].impulse - over_relaxation_ * sides_[i].velocity(first_, second_) / sides_[i].response;
    limit(wanted, friction_ * normal_.impulse);
    const double change = sides_[0].change_to(wanted[0], first_, second_);
    return std::max(change, sides_[1].change_to(wanted[1], first_, second_));
  }

  void resist_rolling() {
    Vec3 wanted =
        rolling_impulse_ - over_relaxation_ * (turn_inverse_ * (second_.turn_velocity - first_.turn_velocity));
    limit(wanted, rolling_arm_ * normal_.impulse);
    change_rolling_to(wanted);
  }

  void change_rolling_to(const Vec3& impulse) {
    const Vec3 change = impulse - rolling_impulse_;
    rolling_impulse_ = impulse;
    first_.turn_velocity -= first_.inverse_inertia * change;
    second_.turn_velocity += second_.inverse_inertia * change;
  }

  template <typename Vector>
  static void limit(Vector& vector, double length_max) {
    const double squared = vector.squaredNorm();
    if (squared > length_max * length_max) vector *= length_max / std::sqrt(squared);
  }

  SolverBody& first_;
  SolverBody& second_;
  double time_step_, over_relaxation_, friction_, rolling_arm_, softness_;
  double separation_speed_ = 0.0;  ///< m/s
  Row normal_, sides_[2];
  Eigen::Matrix3d turn_inverse_;
  Vec3 rolling_impulse_ = Vec3::Zero();  ///< N m s
};

/// Both ways in turn: a sweep carries a load from one end of its order to the other.
double sweep(std::vector<Constraint>& constraints, bool backward) {
  double change = 0.0;
  if (backward)
    for (auto c = constraints.rbegin(); c != constraints.rend(); ++c) change = std::max(change, c->iterate());
  else
    for (Constraint& c : constraints) change = std::max(change, c.iterate());
  return change;
}

}  // namespace

void solve_contacts(const PhysicsOptions& options, double time_step, std::vector<SolverBody> bodies,
                    std::vector<StepContact>& contacts) {
  bodies.emplace_back();  // the bin
  std::vector<Constraint> constraints;
  constraints.reserve(contacts.size());
  for (const StepContact& contact : contacts) constraints.emplace_back(options, time_step, contact, bodies);
  for (int i = 0; i < options.solver_iterations; ++i)
    if (sweep(constraints, i % 2 == 1) < options.solver_tolerance) break;
  for (std::size_t i = 0; i < contacts.size(); ++i) constraints[i].store(contacts[i]);
}

}  // namespace tubebin::physics
