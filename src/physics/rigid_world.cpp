#include "physics/rigid_world.hpp"

#include <ode/ode.h>

#include <cmath>
#include <mutex>
#include <stdexcept>

namespace tubebin {
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

dMass to_ode(const MassProperties& properties) {
  const Eigen::Matrix3d& i = properties.inertia;
  dMass mass;
  dMassSetParameters(&mass, properties.mass, 0, 0, 0, i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2));
  if (!dMassCheck(&mass)) throw std::runtime_error("a tube's inertia is not positive definite");
  return mass;
}

}  // namespace

struct RigidWorld::Impl {
  dWorldID world = nullptr;
  dJointGroupID contacts = nullptr;
  PhysicsOptions options;
  std::vector<Box> bin;
  std::vector<PlacedTube> tubes;  ///< poses are the bodies'
  std::vector<dBodyID> bodies;
  std::vector<Vec3> centers;  ///< of mass, tube frame
  std::vector<std::vector<int>> degrees;
  std::vector<CollisionTube> shapes;
  std::vector<Touch> touches;

  void add_body(const PlacedTube& tube) {
    const MassProperties properties = mass_properties(tube.tube);
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

  /// `first` may be null: the bin.
  void add_contacts(dBodyID first, dBodyID second, double friction) {
    for (const Touch& touch : touches) {
      dContact contact{};
      contact.surface.mode = dContactApprox1 | dContactRolling | dContactSoftERP | dContactSoftCFM;
      contact.surface.rho = contact.surface.rho2 = options.rolling_resistance;
      contact.surface.mu = friction;
      contact.surface.soft_erp = options.contact_erp;
      contact.surface.soft_cfm = options.contact_cfm;
      contact.geom.depth = touch.depth;
      for (int axis = 0; axis < 3; ++axis) {
        contact.geom.pos[axis] = touch.position[axis];
        contact.geom.normal[axis] = touch.normal[axis];  // points into ODE's first body
      }
      dJointAttach(dJointCreateContact(world, contacts, &contact), second, first);
    }
    touches.clear();
  }

  void find_contacts() {
    for (std::size_t j = 0; j < shapes.size(); ++j) {
      collide(bin, shapes[j], 0.0, touches);
      add_contacts(nullptr, bodies[j], options.friction_bin);
      for (std::size_t i = 0; i < j; ++i) {
        collide(shapes[i], shapes[j], 0.0, touches);
        add_contacts(bodies[i], bodies[j], options.friction_tube);
      }
    }
  }

  void limit_speed(dBodyID body) const {
    const dReal* v = dBodyGetLinearVel(body);
    const double speed = to_vec(v).norm();
    if (speed <= options.speed_max) return;
    const double scale = options.speed_max / speed;
    dBodySetLinearVel(body, v[0] * scale, v[1] * scale, v[2] * scale);
  }
};

RigidWorld::RigidWorld(const std::vector<PlacedTube>& tubes, const Bin& bin, const PhysicsOptions& options,
                       std::uint64_t seed)
    : impl_(std::make_unique<Impl>()) {
  init_ode();
  dRandSetSeed(static_cast<unsigned long>(seed & 0xffffffffu));  // quickstep shuffles its constraints with it
  impl_->options = options;
  impl_->bin = collision_boxes(bin);
  impl_->tubes = tubes;
  impl_->world = dWorldCreate();
  impl_->contacts = dJointGroupCreate(0);
  dWorldSetGravity(impl_->world, 0, 0, -options.gravity);
  dWorldSetQuickStepNumIterations(impl_->world, options.solver_iterations);
  dWorldSetQuickStepW(impl_->world, options.solver_over_relaxation);
  dWorldSetContactMaxCorrectingVel(impl_->world, options.correcting_speed_max);
  dWorldSetContactSurfaceLayer(impl_->world, options.contact_layer);
  dWorldSetDamping(impl_->world, options.damping_linear, options.damping_angular);
  for (const PlacedTube& tube : tubes) impl_->add_body(tube);
}

RigidWorld::~RigidWorld() {
  dJointGroupDestroy(impl_->contacts);
  dWorldDestroy(impl_->world);
}

void RigidWorld::set_solver_iterations(int iterations) { dWorldSetQuickStepNumIterations(impl_->world, iterations); }

void RigidWorld::step() {
  impl_->find_contacts();
  dWorldQuickStep(impl_->world, impl_->options.time_step);
  dJointGroupEmpty(impl_->contacts);
  for (std::size_t i = 0; i < impl_->bodies.size(); ++i) {
    impl_->limit_speed(impl_->bodies[i]);
    impl_->read_pose(i);
    update_collision_tube(impl_->tubes[i], impl_->degrees[i], impl_->shapes[i]);
  }
}

std::vector<PlacedTube> RigidWorld::tubes() const { return impl_->tubes; }
Pose RigidWorld::pose(std::size_t tube) const { return impl_->tubes[tube].world_from_tube; }
Vec3 RigidWorld::center_of_mass(std::size_t tube) const { return to_vec(dBodyGetPosition(impl_->bodies[tube])); }
double RigidWorld::speed(std::size_t tube) const { return to_vec(dBodyGetLinearVel(impl_->bodies[tube])).norm(); }
double RigidWorld::turn_rate(std::size_t tube) const { return to_vec(dBodyGetAngularVel(impl_->bodies[tube])).norm(); }
std::size_t RigidWorld::size() const { return impl_->bodies.size(); }

}  // namespace tubebin
