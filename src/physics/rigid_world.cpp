#include "physics/rigid_world.hpp"

#include <ode/ode.h>

#include <algorithm>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "physics/near_pieces.hpp"
#include "physics/warm_start.hpp"

namespace tubebin::physics {
namespace {

/// ODE wants to be initialized once a process and once a thread.
void init_ode() {
  static std::once_flag once;
  std::call_once(once, [] {
    if (!dInitODE2(0)) throw std::runtime_error("ODE can't be initialized");
  });
  dAllocateODEDataForThread(dAllocateMaskAll);
}

Vec3 to_vec(const dReal* v) { return {v[0], v[1], v[2]}; }

dMass to_ode(const tube::MassProperties& properties) {
  const Eigen::Matrix3d& i = properties.inertia;
  dMass mass;
  dMassSetParameters(&mass, properties.mass, 0, 0, 0, i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2));
  if (!dMassCheck(&mass)) throw std::runtime_error("a tube's inertia is not positive definite");
  return mass;
}

}  // namespace

StepSettings step_settings(const PhysicsOptions& options) {
  return {options.time_step, options.solver_iterations, options.warm_start};
}

struct RigidWorld::Impl {
  dWorldID world = nullptr;
  dJointGroupID joints = nullptr;
  PhysicsOptions options;
  std::vector<scene::Box> bin;
  std::vector<scene::PlacedTube> tubes;  ///< poses are the bodies'
  std::vector<dBodyID> bodies;
  std::vector<Vec3> centers;  ///< of mass, tube frame
  std::vector<std::vector<int>> degrees;
  std::vector<CollisionTube> shapes;
  NearPieces near_pieces;
  std::vector<Touch> touches;
  std::vector<StepContact> contacts;  ///< of the last step

  void add_body(const scene::PlacedTube& tube) {
    const tube::MassProperties properties = tube::mass_properties(tube.tube);
    const dMass mass = to_ode(properties);
    const dBodyID body = dBodyCreate(world);
    dBodySetMass(body, &mass);
    const Vec3 center = tube.world_from_tube * properties.center;
    dBodySetPosition(body, center.x(), center.y(), center.z());
    const Quat q(tube.world_from_tube.linear());
    const dQuaternion rotation = {q.w(), q.x(), q.y(), q.z()};
    dBodySetQuaternion(body, rotation);
    bodies.push_back(body);
    centers.push_back(properties.center);
    degrees.push_back(tube.tube.node_degrees());
    shapes.push_back(collision_tube(tube));
  }

  void read_pose(std::size_t i) {
    const dReal* q = dBodyGetQuaternion(bodies[i]);
    const Quat rotation(q[0], q[1], q[2], q[3]);
    tubes[i].world_from_tube = make_pose(rotation, to_vec(dBodyGetPosition(bodies[i])) - rotation * centers[i]);
  }

  void find_contacts() {
    const auto append = [&](std::size_t first, std::size_t second) {
      for (const Touch& touch : touches) contacts.push_back({.first = first, .second = second, .touch = touch});
      touches.clear();
    };
    near_pieces.follow(shapes);
    for (std::size_t j = 0; j < shapes.size(); ++j) {
      collide(bin, shapes[j], 0.0, touches);
      append(kBinBody, j);
      for (std::size_t i = 0; i < j; ++i) {
        collide(shapes[i], shapes[j], near_pieces.pairs(i, j), 0.0, touches);
        append(i, j);
      }
    }
  }

  void add_joint(const StepContact& in, dJointFeedback& feedback) {
    dContact contact{};
    contact.surface.mode = dContactApprox1 | dContactRolling | dContactSoftERP | dContactSoftCFM;
    contact.surface.rho = options.rolling_resistance;
    contact.surface.mu = in.first == kBinBody ? options.friction_bin : options.friction_tube;
    contact.surface.soft_erp = options.contact_erp;
    contact.surface.soft_cfm = options.contact_cfm;
    contact.geom.depth = in.touch.depth;
    for (int axis = 0; axis < 3; ++axis) {
      contact.geom.pos[axis] = in.touch.position[axis];
      contact.geom.normal[axis] = in.touch.normal[axis];  // points into ODE's first body
    }
    const dJointID joint = dJointCreateContact(world, joints, &contact);
    dJointAttach(joint, bodies[in.second], in.first == kBinBody ? nullptr : bodies[in.first]);
    dJointSetFeedback(joint, &feedback);
  }

  Vec3 velocity_at(std::size_t i, const Vec3& point) const {
    const Vec3 arm = point - to_vec(dBodyGetPosition(bodies[i]));
    return to_vec(dBodyGetLinearVel(bodies[i])) + turn_velocity(i).cross(arm);
  }
  Vec3 turn_velocity(std::size_t i) const { return to_vec(dBodyGetAngularVel(bodies[i])); }

  /// Whether the two surfaces hardly move against each other, nor does either tube spin in place.
  bool is_resting(const StepContact& contact) const {
    const Vec3& point = contact.touch.position;
    Vec3 velocity = velocity_at(contact.second, point);
    double turn_rate = turn_velocity(contact.second).norm();
    if (contact.first != kBinBody) {
      velocity -= velocity_at(contact.first, point);
      turn_rate = std::max(turn_rate, turn_velocity(contact.first).norm());
    }
    return std::max(velocity.norm(), turn_rate * shapes[contact.second].radius) < options.warm_start_speed;
  }

  void apply(const ContactLoad& load, const StepContact& contact) const {
    const auto add = [this](std::size_t i, const Vec3& force, const Vec3& torque) {
      dBodyAddForce(bodies[i], force.x(), force.y(), force.z());
      dBodyAddTorque(bodies[i], torque.x(), torque.y(), torque.z());
    };
    add(contact.second, load.force_on_second, load.torque_on_second);
    if (contact.first != kBinBody) add(contact.first, -load.force_on_second, load.torque_on_first);
  }

  /// Finds the contacts, solves the step, and leaves in the contacts what they bore.
  void solve(const StepSettings& settings) {
    const std::size_t room = 2 * contacts.size();
    WarmStart warm_start(std::exchange(contacts, {}));
    contacts.reserve(room);
    find_contacts();
    std::vector<dJointFeedback> feedback(contacts.size());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      StepContact& contact = contacts[i];
      add_joint(contact, feedback[i]);
      if (settings.warm_start == 0.0) continue;
      const double reach = 0.5 * shapes[contact.second].radius;
      contact.load = warm_start.start(contact, settings.warm_start, reach, is_resting(contact));
      apply(contact.load, contact);
    }
    dWorldSetQuickStepNumIterations(world, settings.solver_iterations);
    dWorldQuickStep(world, settings.time_step);
    dJointGroupEmpty(joints);
    for (std::size_t i = 0; i < contacts.size(); ++i) add_solved(feedback[i], contacts[i]);
  }

  static void add_solved(const dJointFeedback& solved, StepContact& contact) {
    contact.load.force_on_second += to_vec(solved.f1);
    contact.load.torque_on_second += to_vec(solved.t1);
    if (contact.first != kBinBody) contact.load.torque_on_first += to_vec(solved.t2);
    contact.normal_force = contact.load.force_on_second.dot(contact.touch.normal);
  }

  void limit_speed(dBodyID body) const {
    const dReal* v = dBodyGetLinearVel(body);
    const double speed = to_vec(v).norm();
    if (speed <= options.speed_max) return;
    const double scale = options.speed_max / speed;
    dBodySetLinearVel(body, v[0] * scale, v[1] * scale, v[2] * scale);
  }
};

RigidWorld::RigidWorld(const std::vector<scene::PlacedTube>& tubes, const scene::Bin& bin,
                       const PhysicsOptions& options, std::uint64_t seed)
    : impl_(std::make_unique<Impl>()) {
  init_ode();
  dRandSetSeed(static_cast<unsigned long>(seed & 0xffffffffu));  // quickstep shuffles its constraints with it
  impl_->options = options;
  impl_->bin = collision_boxes(bin);
  impl_->tubes = tubes;
  impl_->world = dWorldCreate();
  impl_->joints = dJointGroupCreate(0);
  dWorldSetGravity(impl_->world, 0, 0, -options.gravity);
  dWorldSetQuickStepW(impl_->world, options.solver_over_relaxation);
  dWorldSetContactMaxCorrectingVel(impl_->world, options.correcting_speed_max);
  dWorldSetContactSurfaceLayer(impl_->world, options.contact_layer);
  dWorldSetDamping(impl_->world, options.damping_linear, options.damping_angular);
  for (const scene::PlacedTube& tube : tubes) impl_->add_body(tube);
}

RigidWorld::~RigidWorld() {
  dJointGroupDestroy(impl_->joints);
  dWorldDestroy(impl_->world);
}

void RigidWorld::step(const StepSettings& settings) {
  impl_->solve(settings);
  for (std::size_t i = 0; i < impl_->bodies.size(); ++i) {
    impl_->limit_speed(impl_->bodies[i]);
    impl_->read_pose(i);
    update_collision_tube(impl_->tubes[i], impl_->degrees[i], impl_->shapes[i]);
  }
}

const std::vector<scene::PlacedTube>& RigidWorld::tubes() const { return impl_->tubes; }
Pose RigidWorld::pose(std::size_t tube) const { return impl_->tubes[tube].world_from_tube; }
Vec3 RigidWorld::center_of_mass(std::size_t tube) const { return to_vec(dBodyGetPosition(impl_->bodies[tube])); }
double RigidWorld::speed(std::size_t tube) const { return to_vec(dBodyGetLinearVel(impl_->bodies[tube])).norm(); }
double RigidWorld::turn_rate(std::size_t tube) const { return to_vec(dBodyGetAngularVel(impl_->bodies[tube])).norm(); }
std::size_t RigidWorld::size() const { return impl_->bodies.size(); }

}  // namespace tubebin::physics
