// The cost of a World's step relative to ODE without a World: contacts found and constrained in a few lines.

#include <ode/ode.h>
#include <rehearse/world.h>

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pairs.h"
#include "sr1_run.h"

namespace rehearse {
namespace {

constexpr int slice = 100;           // steps measured at a time
constexpr int settled = 500;         // steps before the first measurement
constexpr double side = 0.2;         // of a box [m]
constexpr int stacks = 6, high = 4;  // of boxes of 1 kg
const SolverSettings solver;

/// The centre of the first boxes' places [m]; neighbours don't touch.
Eigen::Vector3d place_of(int stack, int level) { return {0.5 * stack, 0.0, side * (level + 0.5)}; }

WorldBody box(const std::string& name, JointType root, const Eigen::Vector3d& size, const Eigen::Vector3d& place) {
  Model model;
  model.name = name;
  Link& link = model.links.emplace_back();
  link.name = name;
  link.joint.type = root;
  link.inertial = {1.0, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity() * (side * side / 6.0)};
  link.collisions.push_back({"", Box{size}, Eigen::Isometry3d::Identity(), {}, {}});
  WorldBody body;
  body.name = name;
  body.model = std::make_shared<const Model>(std::move(model));
  body.position = place;
  return body;
}

std::unique_ptr<World> stacks_in_a_world() {
  std::vector<WorldBody> bodies{box("Floor", JointType::fixed, {20, 20, side}, {0, 0, -side / 2})};
  for (int stack = 0; stack < stacks; ++stack)
    for (int level = 0; level < high; ++level)
      bodies.push_back(
          box("Box" + std::to_string(bodies.size()), JointType::free, {side, side, side}, place_of(stack, level)));
  WorldSettings settings;
  settings.solver = solver;
  return must(World::create(settings, std::move(bodies)));
}

/// The same boxes in ODE alone, with ODE's pyramid of friction along the world's axes.
class BareStacks {
 public:
  BareStacks() {
    dWorldSetGravity(world_, 0, 0, -WorldSettings().gravity.norm());
    dWorldSetERP(world_, solver.erp);
    dWorldSetCFM(world_, solver.cfm);
    dWorldSetContactMaxCorrectingVel(world_, solver.max_correcting_velocity);
    dWorldSetContactSurfaceLayer(world_, solver.surface_layer);
    dWorldSetQuickStepNumIterations(world_, solver.iterations);
    dWorldSetQuickStepW(world_, solver.over_relaxation);
    dGeomSetPosition(dCreateBox(space_, 20, 20, side), 0, 0, -side / 2);
    dMass mass;
    dMassSetBoxTotal(&mass, 1.0, side, side, side);
    for (int stack = 0; stack < stacks; ++stack)
      for (int level = 0; level < high; ++level) {
        bodies_.push_back(dBodyCreate(world_));
        dBodySetMass(bodies_.back(), &mass);
        const Eigen::Vector3d place = place_of(stack, level);
        dBodySetPosition(bodies_.back(), place.x(), place.y(), place.z());
        dGeomSetBody(dCreateBox(space_, side, side, side), bodies_.back());
      }
  }
  ~BareStacks() {
    dJointGroupDestroy(contacts_);
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
  }
  BareStacks(const BareStacks&) = delete;
  BareStacks& operator=(const BareStacks&) = delete;

  void step() {
    dSpaceCollide(space_, this, [](void* self, dGeomID a, dGeomID b) { static_cast<BareStacks*>(self)->touch(a, b); });
    dWorldQuickStep(world_, WorldSettings().time_step);
    dJointGroupEmpty(contacts_);
  }
  Eigen::Vector3d position(std::size_t box) const { return Eigen::Vector3d(dBodyGetPosition(bodies_[box])); }

 private:
  void touch(dGeomID a, dGeomID b) {
    std::array<dContactGeom, 100> found;
    const int count = dCollide(a, b, static_cast<int>(found.size()), found.data(), sizeof found[0]);
    for (int i = 0; i < count; ++i) {
      dContact contact{};
      contact.geom = found[static_cast<std::size_t>(i)];
      contact.surface.mode = dContactApprox1;
      contact.surface.mu = solver.friction;
      dJointAttach(dJointCreateContact(world_, contacts_, &contact), dGeomGetBody(a), dGeomGetBody(b));
    }
  }

  dWorldID world_ = dWorldCreate();
  dSpaceID space_ = dSimpleSpaceCreate(nullptr);
  dJointGroupID contacts_ = dJointGroupCreate(0);
  std::vector<dBodyID> bodies_;
};

/// Work: World::step(). Base: the same by ODE's functions alone, with the same contacts and iterations.
void world_step_over_bare_ode(benchmark::State& state) {
  const std::unique_ptr<World> world = stacks_in_a_world();  // initialises ODE
  BareStacks bare;
  for (int i = 0; i < settled; ++i) {
    world->step();
    bare.step();
  }
  Pairs pairs;
  for (auto _ : Repeated(state)) {
    state.SetIterationTime(pairs.measure(
        [&] {
          for (int i = 0; i < slice; ++i) world->step();
        },
        [&] {
          for (int i = 0; i < slice; ++i) bare.step();
        }));
  }
  for (std::size_t i = 0; i < stacks * high; ++i)
    if ((world->sense().bodies[i + 1].links[0].position - bare.position(i)).norm() > 1e-3)
      state.SkipWithError("the boxes are at different places: the contacts aren't the same");
  pairs.report(state, slice, slice);
}
BENCHMARK(world_step_over_bare_ode)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rehearse
