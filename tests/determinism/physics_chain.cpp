// Prints a hash over the states of SR1 standing on a floor, tick by tick: physics_chain URDF quick|exact.
// The world's sources are compiled into several programs of this text, each optimised differently.

#include <rehearse/urdf.h>
#include <rehearse/world.h>

#include <cinttypes>
#include <cstdio>
#include <string_view>

int main(int argc, char** argv) {
  using namespace rehearse;
  if (argc != 3) return std::fputs("usage: physics_chain URDF quick|exact\n", stderr), 2;
  auto model = load_urdf(argv[1]);
  if (!model) return std::fputs(to_string(model.errors()).c_str(), stderr), 2;

  WorldSettings settings;
  if (std::string_view(argv[2]) == "exact") settings.solver.method = SolverSettings::Method::exact;
  WorldBody robot;
  robot.name = "SR1";
  robot.model = std::make_shared<const Model>(*std::move(model));
  robot.position.z() = 0.71;
  robot.joints.assign(robot.model->joints.size(), 0.01);
  WorldBody floor;
  floor.name = "Floor";
  floor.model = std::make_shared<const Model>(single_shape_model("Floor", Box{{10, 10, 0.2}}, 0.0, {}));
  floor.fixed = true;
  floor.position.z() = -0.1;
  auto world = World::create(settings, {floor, robot});
  if (!world) return std::fputs(to_string(world.errors()).c_str(), stderr), 2;

  Command command;
  command.bodies.resize(2);
  command.bodies[0].external.resize(1);
  command.bodies[1].joints.resize(robot.joints.size());
  command.bodies[1].external.resize(robot.model->links.size());
  std::uint64_t chain = 0;
  for (int tick = 0; tick < 400; ++tick) {
    const BodyObservation& seen = (*world)->sense().bodies[1];
    for (std::size_t id = 0; id < seen.joints.size(); ++id)
      command.bodies[1].joints[id] = {drive_effort, 0.0, 0.0, -3000.0 * seen.joints[id].q - 100.0 * seen.joints[id].dq};
    (*world)->actuate(command);
    if (!(*world)->step()) return 1;
    chain = chain * 0x9e3779b97f4a7c15u + (*world)->state_hash();
  }
  std::printf("%016" PRIx64 "\n", chain);
}
