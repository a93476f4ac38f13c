#include <ode/ode.h>
#include <rehearse/world.h>

#include <algorithm>
#include <cstring>

#include "base/clock.h"
#include "base/digest.h"
#include "beams.h"
#include "connections.h"
#include "contacts.h"
#include "direct_step.h"
#include "friction.h"
#include "kinematic_body.h"
#include "ode_body.h"
#include "ode_runtime.h"
#include "sleep.h"
#include "state_by_name.h"
#include "touches.h"

namespace rehearse {
namespace {

/// Writes over the bytes, which have the size of the state that they held before: the next state rarely has another.
class Saver final : public StateVisitor {
 public:
  explicit Saver(std::vector<std::byte>& bytes) : bytes_(bytes) { copy_to(bytes_); }
  /// Removes the bytes behind the state.
  void finish() { bytes_.resize(used()); }

 private:
  void enter(const std::string&, const std::string&, StatePart) override {}
  void take(void* data, std::size_t size) override {
    const std::size_t before = used();
    bytes_.resize(2 * (before + size));
    copy_to(std::span(bytes_).subspan(before));
    visit(data, size);
  }
  std::size_t used() const { return bytes_.size() - free(); }

  std::vector<std::byte>& bytes_;
};

class Restorer final : public StateVisitor {
 public:
  explicit Restorer(std::span<const std::byte> bytes) : bytes_(bytes) {}

 private:
  void enter(const std::string&, const std::string&, StatePart) override {}
  void take(void* data, std::size_t size) override {
    std::memcpy(data, bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
  }

  std::span<const std::byte> bytes_;
};

}  // namespace

namespace {
constexpr int substitute_iterations = 1000;  // of the quick solver where the exact one fails
}  // namespace

struct World::Impl {
  WorldSettings settings;
  ContactLaw law;
  dWorldID world = nullptr;
  std::unique_ptr<OwnJobs> jobs;  // destroyed after the world
  dJointGroupID contacts = nullptr;
  std::vector<std::unique_ptr<SimulatedBody>> bodies;
  std::unique_ptr<Connections> connections;  // refers to the bodies
  std::vector<dContactGeom> found;           // room for the contacts of two shapes
  Touches touches;                           // refers to the bodies
  Friction friction;
  std::unique_ptr<DirectStep> direct;  // refers to the bodies; null: ODE solves all
  std::unique_ptr<Sleep> sleep;        // refers to the bodies
  std::vector<LinkPair> touching;
  std::uint64_t random = 0;
  std::int64_t tick = 0;
  bool exploded = false;  // ODE stopped during a step
  bool diverged = false;  // the direct solver found no finite velocities
  std::string solver_message;
  Residual residual;
  Unsolved unsolved;
  Command command;
  mutable Observation observation;
  mutable bool observed = false;
  mutable std::vector<std::byte> scratch;

  Impl(const WorldSettings& of, const std::vector<WorldBody>& with)
      : settings(of),
        law(of, with),
        found(static_cast<std::size_t>(of.solver.max_contacts)),
        friction(of.time_step, of.gravity.norm()),
        random(of.seed) {}
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    bodies.clear();  // geoms before the ODE bodies to which they belong
    if (contacts) dJointGroupDestroy(contacts);
    if (world) dWorldDestroy(world);
  }

  void create_world();
  void apply_command();
  void step_bodies();
  void step_directly();
  void measure_residual(int iterations);
  double missing_contact_share() const;
  std::vector<dBodyID> ode_bodies() const;

  /// Visits the state except that of friction, whose size changes.
  void visit_state(StateVisitor& visitor) {
    visitor.begin_part("", "", StatePart::clock);
    visitor.visit(&tick, sizeof tick);
    visitor.visit(&random, sizeof random);
    for (auto& body : bodies) body->visit_state(visitor);
    connections->visit_state(visitor);
    sleep->visit_state(visitor);
  }
  void after_restore();
  void save_to(std::vector<std::byte>& bytes) {
    Saver saver(bytes);
    visit_state(saver);
    saver.finish();
    friction.save(bytes);
  }
  bool has_links_of(const std::map<LinkPair, FrictionPatch>& patches) const;
  void take_friction(const Impl& other);
};

World::World(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
World::~World() {
  if (!impl_->exploded) return;
  // After an aborted step ODE's data are inconsistent and can't be freed; they are kept until the process ends.
  static std::vector<Impl*>& abandoned = *new std::vector<Impl*>;
  abandoned.push_back(impl_.release());
}

void World::Impl::create_world() {
  const SolverSettings& solver = settings.solver;
  world = dWorldCreate();
  jobs = std::make_unique<OwnJobs>(world);
  contacts = dJointGroupCreate(0);
  dWorldSetGravity(world, settings.gravity.x(), settings.gravity.y(), settings.gravity.z());
  dWorldSetERP(world, solver.erp);
  dWorldSetCFM(world, solver.cfm);
  dWorldSetContactMaxCorrectingVel(world, law.ode_correcting_velocity());
  dWorldSetContactSurfaceLayer(world, solver.surface_layer);
  const bool exact = solver.method == SolverSettings::Method::exact;
  dWorldSetQuickStepNumIterations(world, !exact ? solver.iterations : substitute_iterations);
  dWorldSetQuickStepW(world, solver.over_relaxation);
  dWorldSetAutoDisableFlag(world, 0);
}

Result<std::unique_ptr<World>> World::create(const WorldSettings& settings, std::vector<WorldBody> bodies) {
  Diagnostics findings;
  for (const WorldBody& body : bodies) {
    const Diagnostics of_body = check_dynamics(body);
    findings.insert(findings.end(), of_body.begin(), of_body.end());
    if (settings.solver.method == SolverSettings::Method::direct) continue;
    const Diagnostics of_mimics = check_mimics(body);
    findings.insert(findings.end(), of_mimics.begin(), of_mimics.end());
  }
  if (!findings.empty()) return findings;

  initialise_ode();
  std::unique_ptr<World> world(new World(std::make_unique<Impl>(settings, bodies)));
  Impl& impl = *world->impl_;
  impl.create_world();
  for (WorldBody& body : bodies) {
    BodyCommand none;
    none.joints.resize(body.model->joints.size());
    none.external.resize(body.model->links.size());
    none.devices.resize(body.model->devices.size());
    impl.command.bodies.push_back(std::move(none));
    if (body.kinematic)
      impl.bodies.push_back(std::make_unique<KinematicBody>(impl.world, std::move(body), settings.time_step));
    else
      impl.bodies.push_back(std::make_unique<OdeBody>(impl.world, std::move(body), settings.time_step));
  }
  impl.connections = std::make_unique<Connections>(impl.world, impl.bodies, settings.connections);
  if (findings = impl.connections->check(); !findings.empty()) return findings;
  impl.sleep = std::make_unique<Sleep>(settings, impl.bodies);
  if (settings.solver.method == SolverSettings::Method::direct)
    impl.direct = std::make_unique<DirectStep>(settings, impl.law.ode_correcting_velocity(), impl.bodies);
  return world;
}

Diagnostics World::remarks() const {
  Diagnostics remarks;
  for (const auto& body : impl_->bodies) remarks.insert(remarks.end(), body->remarks().begin(), body->remarks().end());
  return remarks;
}

const Observation& World::sense() const {
  if (!impl_->observed) {
    impl_->observation.bodies.resize(impl_->bodies.size());
    for (std::size_t i = 0; i < impl_->bodies.size(); ++i)
      impl_->bodies[i]->observe(impl_->observation.bodies[i], impl_->settings, impl_->tick > 0);
    for (BodyObservation& body : impl_->observation.bodies)
      for (DeviceReading& device : body.devices) device.measured_at = time();
    impl_->observed = true;
  }
  return impl_->observation;
}

std::vector<float> World::measure_ranges(int body, int device) const {
  const Device& of = impl_->bodies.at(body)->description().model->devices.at(device);
  const LinkReading& link = sense().bodies[body].links[of.link];
  return measure_beams(std::get<RangeSensor>(of.kind), pose_of(link) * of.pose, impl_->bodies, body, of.link);
}

void World::watch(int body, int link) {
  SimulatedBody& watched = *impl_->bodies.at(body);
  REHEARSE_ASSERT(link >= 0 && static_cast<std::size_t>(link) < watched.description().model->links.size(),
                  "a watched link is one of its model's");
  watched.watch(link);
  impl_->observed = false;
}

const std::string& World::solver_message() const { return impl_->solver_message; }

const Unsolved& World::unsolved() const { return impl_->unsolved; }

const Residual& World::residual() const { return impl_->residual; }

const std::vector<LinkPair>& World::touching() const { return impl_->touching; }

const std::vector<std::string>& World::events() const { return impl_->connections->events(); }

void World::command_device(int body, int device, const std::vector<double>& values) {
  impl_->bodies.at(body)->command(device, values);
}

void World::actuate(const Command& command) {
  REHEARSE_ASSERT(command.bodies.size() == impl_->bodies.size(), "a command has an entry for each body");
  impl_->command = command;
}

void World::push(int body, int link, const Eigen::Vector3d& force, const Eigen::Vector3d& point,
                 const Eigen::Vector3d& torque) {
  SimulatedBody& pushed = *impl_->bodies.at(body);
  pushed.add_wrench(link, force, torque + pushed.link_point(link, point).cross(force));
}

void World::Impl::apply_command() {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bodies[i]->drive(command.bodies[i]);
    std::vector<Wrench>& external = command.bodies[i].external;
    for (std::size_t link = 0; link < external.size(); ++link) {
      if (external[link].force.isZero(0.0) && external[link].torque.isZero(0.0)) continue;
      bodies[i]->add_wrench(static_cast<int>(link), external[link].force, external[link].torque);
      external[link] = {};  // it acts during one step only
    }
  }
}

std::vector<dBodyID> World::Impl::ode_bodies() const {
  std::vector<dBodyID> all;
  for (const auto& body : bodies) {
    const std::vector<dBodyID> of_body = body->ode_bodies();
    all.insert(all.end(), of_body.begin(), of_body.end());
  }
  return all;
}

/// Of the bodies that the quick solver has moved: the others are hidden from it.
void World::Impl::measure_residual(int iterations) {
  residual = {};
  residual.iterations = iterations;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const JointErrors worst = bodies[i]->residual();
    const int body = static_cast<int>(i);
    if (worst.missed >= 0 && worst.velocity > residual.velocity) {
      residual.missed = {body, worst.missed};
      residual.velocity = worst.velocity;
    }
    if (worst.link < 0 || (residual.joint.body >= 0 && worst.share <= residual.share)) continue;
    residual.joint = {body, worst.link};
    residual.share = worst.share;
  }
}

/// Of the contacts that the quick solver got beside the direct one; see Unsolved::contact_share.
double World::Impl::missing_contact_share() const {
  constexpr double standard_gravity = 9.80665;  // [m/s²]
  double most = 0.0;
  for (const Touches::Contact& contact : touches.contacts()) {
    if (direct->solves(contact) || sleep->is_asleep(contact)) continue;
    double inverse = 0.0, lightest = std::numeric_limits<double>::infinity();
    for (const Touches::Contact::Side* side : {&contact.a, &contact.b}) {
      if (!side->yields()) continue;
      dMass mass;
      dBodyGetMass(side->ode, &mass);
      inverse += 1.0 / mass.mass;
      lightest = std::min(lightest, mass.mass);
    }
    const double approach = -contact.velocity().dot(vector(contact.geom.normal));  // [m/s]
    most = std::max(most, approach / (inverse * lightest * standard_gravity * settings.time_step));
  }
  return most;
}

/// Bodies that the direct solver moves are hidden from ODE, which makes a quick step of the others.
void World::Impl::step_directly() {
  const DirectStep::Outcome outcome = direct->solve();
  diverged = !outcome.finite;
  if (diverged) return;
  constexpr double converged = 1e-6;  // share of the weight
  unsolved = {outcome.error > converged ? outcome.error : 0.0, outcome.crowd.contacts, outcome.crowd.most, 0.0};
  residual = {};
  if (!direct->leaves_bodies()) return;
  direct->hide_from_ode(true);
  exploded = !step_ode(world, settings.time_step, true);
  if (exploded) return;
  measure_residual(settings.solver.iterations);
  unsolved.contact_share = missing_contact_share();
  direct->hide_from_ode(false);
}

/// ODE's exact solver fails on many degenerate sets of contacts: it reports "LCP internal error" and drops all
/// constraints that it hasn't solved yet. The quick solver then makes the step instead.
void World::Impl::step_bodies() {
  solver_message.clear();
  OwnRandom own_random(random);
  if (direct) return step_directly();
  if (settings.solver.method == SolverSettings::Method::quick) {
    exploded = !step_ode(world, settings.time_step, true);
    if (!exploded) measure_residual(settings.solver.iterations);
    return;
  }
  const OdeMotions before(ode_bodies());
  exploded = !step_ode(world, settings.time_step, false);
  const std::vector<std::string> messages = take_ode_messages();
  if (exploded) return;
  residual = {};
  if (messages.empty()) return;
  solver_message = messages.front();
  before.restore();
  exploded = !step_ode(world, settings.time_step, true);
  if (!exploded) measure_residual(substitute_iterations);
}

bool World::step() {
  Impl& impl = *impl_;
  for (auto& body : impl.bodies) body->before_step(time());
  impl.apply_command();
  impl.connections->update(time());
  find_contacts(impl.bodies, *impl.connections, impl.found, impl.touches, impl.friction, impl.touching);
  impl.connections->update_holders(impl.touching);
  impl.sleep->wake(impl.touches);
  if (impl.direct) impl.direct->begin(impl.touches, *impl.connections);
  add_contacts(impl.world, impl.contacts, impl.law, impl.friction, *impl.sleep, impl.touches, impl.direct.get());
  impl.step_bodies();
  ++impl.tick;
  impl.observed = false;
  if (impl.exploded || impl.diverged) return false;
  dJointGroupEmpty(impl.contacts);
  impl.friction.end();
  for (const Touches::Contact& contact : impl.touches.contacts()) Friction::add_force(contact.point(), contact.force());
  for (auto& body : impl.bodies)
    if (body->feels()) body->take_touches(impl.touches.of(*body));
  for (auto& body : impl.bodies) body->after_step();
  impl.sleep->end_step(impl.touches);
  for (const auto& body : impl.bodies)
    if (!body->plausible()) return false;
  return true;
}

std::int64_t World::tick() const { return impl_->tick; }
double World::time() const { return time_of(impl_->tick, impl_->settings.time_step); }

std::uint64_t World::state_hash() const {
  impl_->save_to(impl_->scratch);
  return digest_of(impl_->scratch.data(), impl_->scratch.size());
}

std::vector<std::byte> World::save() const {
  std::vector<std::byte> bytes;
  impl_->save_to(bytes);
  return bytes;
}

Result<void> World::restore(std::span<const std::byte> state) {
  impl_->save_to(impl_->scratch);
  const std::size_t size = impl_->scratch.size() - impl_->friction.saved_size();
  auto patches = state.size() < size ? std::nullopt : Friction::read(state.subspan(size));
  if (!patches || !impl_->has_links_of(*patches))
    return error("the state is of another robot or version: it has " + std::to_string(state.size()) +
                 " bytes, and that of this world has " + std::to_string(size) + " and those of friction");
  Restorer restorer(state);
  impl_->visit_state(restorer);
  impl_->friction.set_patches(*std::move(patches));
  impl_->after_restore();
  return {};
}

Result<void> World::take_state(const World& other) {
  StateByName state;
  other.impl_->visit_state(state);
  StateTaker taker(std::move(state));
  impl_->visit_state(taker);
  if (Diagnostics missing = taker.missing(); !missing.empty()) return missing;
  for (auto& body : impl_->bodies)
    for (const auto& same : other.impl_->bodies)
      if (same->description().name == body->description().name) body->take_centers(*same);
  impl_->take_friction(*other.impl_);
  impl_->after_restore();
  return {};
}

bool World::Impl::has_links_of(const std::map<LinkPair, FrictionPatch>& patches) const {
  const auto has = [&](int body, int link) {
    return body >= 0 && static_cast<std::size_t>(body) < bodies.size() && link >= 0 &&
           static_cast<std::size_t>(link) < bodies[body]->description().model->links.size();
  };
  return std::ranges::all_of(patches, [&](const auto& patch) {
    const LinkPair& pair = patch.first;
    return has(pair.body, pair.link) && has(pair.other_body, pair.other_link);
  });
}

/// Takes the friction of the links that exist in both worlds.
void World::Impl::take_friction(const Impl& other) {
  /// Index of the body and of its link that have the names of the other world's; -1: none.
  const auto find = [&](int body, int link) {
    const WorldBody& named = other.bodies[body]->description();
    for (std::size_t i = 0; i < bodies.size(); ++i)
      if (const WorldBody& same = bodies[i]->description(); same.name == named.name)
        return std::pair(static_cast<int>(i), same.model->find_link(named.model->links[link].name));
    return std::pair(-1, -1);
  };
  std::map<LinkPair, FrictionPatch> taken;
  for (auto [pair, patch] : other.friction.patches()) {
    const auto [body, link] = find(pair.body, pair.link);
    const auto [other_body, other_link] = find(pair.other_body, pair.other_link);
    if (link < 0 || other_link < 0) continue;
    const LinkPair here = LinkPair::of(body, link, other_body, other_link);
    if (here.body != body || here.link != link) {  // the other link comes first here
      patch.force = -patch.force;
      patch.torque = -patch.torque;
    }
    taken[here] = patch;
  }
  friction.set_patches(std::move(taken));
}

void World::Impl::after_restore() {
  for (auto& body : bodies) {
    body->after_restore();
    body->forget_touches();
  }
  connections->after_restore();
  sleep->after_restore();
  touching.clear();
  solver_message.clear();
  residual = {};
  unsolved = {};
  observed = false;
}

void World::nudge(std::uint32_t pattern) {
  for (std::size_t i = 0; i < impl_->bodies.size(); ++i) {
    const std::uint64_t number = i;
    impl_->bodies[i]->nudge(digest_of(&number, sizeof number, pattern));
  }
  impl_->observed = false;
}

std::string World::engine_description() {
  initialise_ode();
  const std::string configuration = dGetConfiguration();
  const bool is_double = configuration.find("ODE_double_precision") != std::string::npos;
  // with each change of this library that moves bits of a world: a golden of another step is told from a fault by it
  constexpr const char* step = ", step 3";
  return std::string("ODE " dODE_VERSION) + (is_double ? ", double precision" : ", single precision") + step;
}

}  // namespace rehearse
