#include "physics/rigid_world.hpp"

#include <ode/ode.h>

#include <algorithm>
#include <iterator>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <utility>

#include "physics/mesh_collision.hpp"
#include "physics/near_cylinders.hpp"
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

struct RigidWorld::Impl {
  dThreadingImplementationID threading = nullptr;  ///< its own: worlds that share one can't step on several threads
  dWorldID world = nullptr;
  PhysicsOptions options;
  scene::Bin bin;
  std::vector<CollisionBox> boxes;  ///< of the bin, with its guards while they stand
  scene::TriangleTree mesh;         ///< of the bin
  bool guards_stand = false;
  std::optional<std::size_t> pulled;     ///< the tube that is held, whatever pushes
  std::vector<scene::PlacedTube> tubes;  ///< poses are the bodies'
  std::vector<dBodyID> bodies;
  std::vector<tube::MassProperties> masses;
  std::vector<double> inverse_masses;             ///< 1/kg
  std::vector<Eigen::Matrix3d> inverse_inertias;  ///< about the centre of mass, tube frame
  std::vector<CollisionTube> shapes;
  NearCylinders near_cylinders;
  std::vector<Touch> touches;
  std::vector<StepContact> contacts;  ///< of the last step

  void add_body(const scene::PlacedTube& tube, const tube::MassProperties& properties) {
    const dMass mass = to_ode(properties);
    const dBodyID body = dBodyCreate(world);
    dBodySetMass(body, &mass);
    set_pose(body, tube.world_from_tube, properties.center);
    bodies.push_back(body);
    inverse_masses.push_back(1.0 / properties.mass);
    inverse_inertias.push_back(properties.inertia.inverse());
    shapes.emplace_back(tube);
  }

  void remove(std::size_t i) {
    dBodyDestroy(bodies[i]);
    const auto erase = [i](auto& of_each) { of_each.erase(of_each.begin() + static_cast<std::ptrdiff_t>(i)); };
    erase(tubes), erase(bodies), erase(masses), erase(inverse_masses), erase(inverse_inertias), erase(shapes);
    near_cylinders = {};
    std::erase_if(contacts, [i](const StepContact& c) { return c.first == i || c.second == i; });
    for (StepContact& contact : contacts) {
      if (contact.first != kBinBody && contact.first > i) --contact.first;
      if (contact.second > i) --contact.second;
    }
  }

  static void set_pose(dBodyID body, const Pose& world_from_tube, const Vec3& center_in_tube) {
    const Vec3 center = world_from_tube * center_in_tube;
    dBodySetPosition(body, center.x(), center.y(), center.z());
    const Quat q(world_from_tube.linear());
    const dQuaternion rotation = {q.w(), q.x(), q.y(), q.z()};
    dBodySetQuaternion(body, rotation);
  }

  void read_pose(std::size_t i) {
    const dReal* q = dBodyGetQuaternion(bodies[i]);
    const Quat rotation(q[0], q[1], q[2], q[3]);
    tubes[i].world_from_tube = make_pose(rotation, to_vec(dBodyGetPosition(bodies[i])) - rotation * masses[i].center);
  }

  /// How far a tube's surface may come in a step, metres. What is so near counts as a contact with a gap, so that nothing
  /// runs into something within the step; nor does a contact end that opens by no more than the contact layer.
  double margin_of(std::size_t i, double time_step) const {
    const Vec3 center = to_vec(dBodyGetPosition(bodies[i]));
    const Vec3 reach = (shapes[i].bounds.max() - center).cwiseMax(center - shapes[i].bounds.min());
    const double speed =
        to_vec(dBodyGetLinearVel(bodies[i])).norm() + to_vec(dBodyGetAngularVel(bodies[i])).norm() * reach.norm();
    return std::max(options.contact_layer, time_step * std::min(speed, 2.0 * options.speed_max));
  }

  void find_contacts(double time_step) {
    const auto append = [&](std::size_t first, std::size_t second) {
      for (const Touch& touch : touches) contacts.push_back({.first = first, .second = second, .touch = touch});
      touches.clear();
    };
    std::vector<double> margins;
    for (std::size_t i = 0; i < shapes.size(); ++i) margins.push_back(margin_of(i, time_step));
    near_cylinders.follow(shapes, margins);
    for (std::size_t j = 0; j < shapes.size(); ++j) {
      if (pulled != j && !is_asleep(j)) {
        collide(boxes, shapes[j], -margins[j], touches);
        collide(mesh, shapes[j], -margins[j], touches);
      }
      append(kBinBody, j);
      for (const NearTube& near : near_cylinders.near(j)) {
        if (is_asleep(j) && is_asleep(near.first)) continue;
        collide(shapes[near.first], shapes[j], near.cylinders, -std::max(margins[near.first], margins[j]), touches);
        append(near.first, j);
      }
    }
    for (StepContact& contact : contacts) contact.friction = friction_of(contact);
  }

  /// The guards are smooth: nothing clings to them.
  double friction_of(const StepContact& contact) const {
    if (contact.first != kBinBody) return options.friction_tube;
    return guards_stand && contact.touch.position.z() > bin.height + options.penetration_max ? 0.0
                                                                                             : options.friction_bin;
  }

  /// The tube at the step's end, were there no contacts.
  SolverBody unhindered(std::size_t i, double time_step) const {
    if (pulled == i)
      return {.velocity = to_vec(dBodyGetLinearVel(bodies[i])), .center = to_vec(dBodyGetPosition(bodies[i]))};
    const Eigen::Matrix3d rotation = tubes[i].world_from_tube.linear();
    return {.velocity = to_vec(dBodyGetLinearVel(bodies[i])) - time_step * options.gravity * Vec3::UnitZ(),
            .turn_velocity = to_vec(dBodyGetAngularVel(bodies[i])),
            .center = to_vec(dBodyGetPosition(bodies[i])),
            .inverse_mass = inverse_masses[i],
            .inverse_inertia = rotation * inverse_inertias[i] * rotation.transpose()};
  }

  void apply(const StepContact& contact) const {
    const auto add = [&](std::size_t i, const Vec3& force, const Vec3& torque) {
      const Vec3& at = contact.touch.position;
      dBodyAddForceAtPos(bodies[i], force.x(), force.y(), force.z(), at.x(), at.y(), at.z());
      dBodyAddTorque(bodies[i], torque.x(), torque.y(), torque.z());
    };
    add(contact.second, contact.force, contact.resistance);
    if (contact.first != kBinBody) add(contact.first, -contact.force, -contact.resistance);
  }

  /// A tube that sleeps stands still, with the contacts that it has, until something touches it.
  bool is_asleep(std::size_t i) const { return !dBodyIsEnabled(bodies[i]); }

  /// All tubes in a chain of `touching` contacts with the tube wake.
  void wake(std::size_t tube, const std::vector<StepContact>& touching) {
    dBodyEnable(bodies[tube]);
    for (const StepContact& contact : touching) {
      if (contact.first == kBinBody || (contact.first != tube && contact.second != tube)) continue;
      const std::size_t other = contact.first == tube ? contact.second : contact.first;
      if (is_asleep(other)) wake(other, touching);
    }
  }

  /// Those that something awake touches now, and what they have touched `before`. Whether there were any.
  bool wake_touched(const std::vector<StepContact>& before) {
    bool woke = false;
    for (const StepContact& contact : contacts)
      for (const std::size_t tube : {contact.first, contact.second})
        if (tube != kBinBody && is_asleep(tube)) wake(tube, before), woke = true;
    return woke;
  }

  /// Contacts of tubes that sleep stay as they are.
  void keep_sleeping_contacts(const std::vector<StepContact>& before) {
    const auto awake = std::ssize(contacts);
    std::ranges::copy_if(before, std::back_inserter(contacts),
                         [this](const StepContact& contact) { return is_asleep(contact.second); });
    std::ranges::inplace_merge(contacts, contacts.begin() + awake, {}, contact_bodies);
  }

  /// Finds the contacts and what they bear, and lets ODE move the bodies under those forces.
  void solve(double time_step) {
    const std::size_t room = 2 * contacts.size();
    const std::vector<StepContact> before = std::exchange(contacts, {});
    do {
      contacts.clear();
      contacts.reserve(room);
      find_contacts(time_step);
    } while (wake_touched(before));
    warm_start(before, options.warm_start, shapes, contacts);
    std::vector<SolverBody> unhindered_bodies;
    for (std::size_t i = 0; i < bodies.size(); ++i) unhindered_bodies.push_back(unhindered(i, time_step));
    solve_contacts(options, time_step, std::move(unhindered_bodies), contacts);
    for (const StepContact& contact : contacts) apply(contact);
    dWorldQuickStep(world, time_step);
    keep_sleeping_contacts(before);
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
                       const PhysicsOptions& options, PileForces forces, std::vector<tube::MassProperties> masses)
    : impl_(std::make_unique<Impl>()) {
  init_ode();
  impl_->options = options;
  impl_->bin = bin;
  impl_->boxes = collision_boxes(bin);
  impl_->mesh = scene::TriangleTree(scene::mesh_triangles(bin));
  impl_->tubes = tubes;
  impl_->contacts = std::move(forces.contacts);
  impl_->threading = dThreadingAllocateSelfThreadedImplementation();
  impl_->world = dWorldCreate();
  dWorldSetStepThreadingImplementation(impl_->world, dThreadingImplementationGetFunctions(impl_->threading),
                                       impl_->threading);
  dWorldSetGravity(impl_->world, 0, 0, -options.gravity);
  dWorldSetDamping(impl_->world, options.damping_linear, options.damping_angular);
  impl_->masses = std::move(masses);
  for (std::size_t i = impl_->masses.size(); i < tubes.size(); ++i)
    impl_->masses.push_back(tube::mass_properties(tubes[i].tube));
  for (std::size_t i = 0; i < tubes.size(); ++i) impl_->add_body(tubes[i], impl_->masses[i]);
}

RigidWorld::RigidWorld(RigidWorld&&) noexcept = default;

RigidWorld::~RigidWorld() {
  if (!impl_) return;  // moved from
  dWorldDestroy(impl_->world);
  dThreadingFreeImplementation(impl_->threading);
}

void RigidWorld::step(double time_step) {
  impl_->solve(time_step);
  for (std::size_t i = 0; i < impl_->bodies.size(); ++i) {
    if (impl_->is_asleep(i)) continue;
    impl_->limit_speed(impl_->bodies[i]);
    impl_->read_pose(i);
    impl_->shapes[i].follow(impl_->tubes[i]);
  }
}

void RigidWorld::raise_guards(double height) {
  scene::Bin guarded = impl_->bin;
  guarded.height = std::max(guarded.height, height);
  impl_->boxes = guarded.has_mesh() ? guard_boxes(impl_->bin, height) : collision_boxes(guarded);
  impl_->guards_stand = true;
}

void RigidWorld::remove_guards() {
  impl_->boxes = collision_boxes(impl_->bin);
  impl_->guards_stand = false;
}
bool RigidWorld::has_guards() const { return impl_->guards_stand; }

void RigidWorld::let_sleep_beyond(std::size_t tube) {
  if (impl_->contacts.empty()) return;  // nobody knows yet what touches what
  for (const dBodyID body : impl_->bodies) dBodyDisable(body);
  impl_->wake(tube, impl_->contacts);
}

void RigidWorld::pull(std::size_t tube, double speed) {
  impl_->pulled = tube;
  dBodySetKinematic(impl_->bodies[tube]);
  dBodySetLinearVel(impl_->bodies[tube], 0, 0, speed);
  dBodySetAngularVel(impl_->bodies[tube], 0, 0, 0);
}

void RigidWorld::remove_pulled() {
  impl_->remove(impl_->pulled.value());
  impl_->pulled.reset();
}

double RigidWorld::pulling_force() const {
  const std::size_t tube = impl_->pulled.value();
  double force = impl_->options.gravity / impl_->inverse_masses[tube];
  for (const StepContact& contact : impl_->contacts) {
    if (contact.second == tube) force -= contact.force.z();
    if (contact.first == tube) force += contact.force.z();
  }
  return force;
}

bool RigidWorld::touches_another(std::size_t tube) const {
  return std::ranges::any_of(impl_->contacts, [&](const StepContact& contact) {
    return contact.first != kBinBody && (contact.first == tube || contact.second == tube);
  });
}

void RigidWorld::put(std::size_t tube, const Pose& world_from_tube) {
  impl_->tubes[tube].world_from_tube = world_from_tube;
  impl_->set_pose(impl_->bodies[tube], world_from_tube, impl_->masses[tube].center);
  dBodySetLinearVel(impl_->bodies[tube], 0, 0, 0);
  dBodySetAngularVel(impl_->bodies[tube], 0, 0, 0);
  impl_->shapes[tube].follow(impl_->tubes[tube]);
}

PileForces RigidWorld::forces() const { return {impl_->contacts}; }
const std::vector<scene::PlacedTube>& RigidWorld::tubes() const { return impl_->tubes; }
const std::vector<tube::MassProperties>& RigidWorld::masses() const { return impl_->masses; }
Pose RigidWorld::pose(std::size_t tube) const { return impl_->tubes[tube].world_from_tube; }
scene::Box RigidWorld::bounds(std::size_t tube) const { return impl_->shapes[tube].bounds; }
Vec3 RigidWorld::center_of_mass(std::size_t tube) const { return to_vec(dBodyGetPosition(impl_->bodies[tube])); }
double RigidWorld::speed(std::size_t tube) const { return to_vec(dBodyGetLinearVel(impl_->bodies[tube])).norm(); }
double RigidWorld::turn_rate(std::size_t tube) const { return to_vec(dBodyGetAngularVel(impl_->bodies[tube])).norm(); }
std::size_t RigidWorld::size() const { return impl_->bodies.size(); }

}  // namespace tubebin::physics
