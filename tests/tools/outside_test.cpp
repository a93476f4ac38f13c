// The command with projects and bodies of others: import, inspect, and what controllers write.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

class Outside : public Command {
 protected:
  std::string drone() const {
    return write("drone.body",
                 "format: ChoreonoidBody\nformat_version: 2.0\nname: drone\nlinks:\n  - name: BASE\n    joint_type: "
                 "free\n"
                 "    mass: 1\n    elements:\n      - { type: Rotor, name: FRONT }\n")
        .string();
  }
  std::string project(const std::string& file) const {
    return write("drone.cnoid",
                 "items:\n  class: RootItem\n  children:\n    - class: WorldItem\n      name: World\n      data: { "
                 "default_material_table_file: \"" +
                     (fixtures / "projects/materials.yaml").string() +
                     "\" }\n      children:\n        - { class: BodyItem, name: Drone, data: { file: \"" + file +
                     "\" } }\n    - { class: ODESimulatorItem, name: ODE, data: { time_range_mode: specified, "
                     "time_length: 1 } }\n")
        .string();
  }
};

/// 4: what of the run is left out is a warning; 2: nothing is written.
TEST_F(Outside, DevicesOfPluginsAreLeftOutWithAWarningEach) {
  const std::string cnoid = project(drone());
  EXPECT_EQ(run(command, {"import", cnoid, "-o", "refused"}).status, 2);
  EXPECT_FALSE(exists("refused"));
  const Outcome allowed = run(command, {"import", cnoid, "-o", "allowed", "--allow-unknown-devices"});
  EXPECT_EQ(allowed.status, 4) << allowed.err;
  EXPECT_THAT(allowed.err, HasSubstr("drone.body:9: warning: the device 'Rotor' 'FRONT' isn't known; it is left out"));
  const Outcome recorded = run(command, {"record", "allowed/drone.yaml", "-o", "drone.mcap"});
  EXPECT_EQ(recorded.status, 0) << recorded.err;
  EXPECT_EQ(run(command, {"record", "--from-checkpoint", "drone.mcap@0.5s", "-o", "branch.mcap"}).status, 0);
  EXPECT_EQ(run(command, {"report", "drone.mcap", "-o", "drone.html"}).status, 0);
  EXPECT_EQ(run(command, {"inspect", drone()}).status, 2);
  EXPECT_EQ(run(command, {"inspect", drone(), "--allow-unknown-devices"}).status, 0);
}

TEST_F(Outside, FilesBelowVariablesAreFoundByAnOption) {
  drone();
  const std::string cnoid = project("${ROBOTS}/models/drone.body");
  fs::create_directories(folder() / "elsewhere/models");
  fs::rename(folder() / "drone.body", folder() / "elsewhere/models/drone.body");
  const Outcome refused = run(command, {"import", cnoid, "-o", "a"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("--variable ROBOTS=DIR"));
  const Outcome found =
      run(command, {"import", cnoid, "-o", "a", "--variable", "ROBOTS=elsewhere", "--allow-unknown-devices"});
  EXPECT_EQ(found.status, 4) << found.err;
  EXPECT_THAT(read_file(folder() / "a/drone.yaml"), HasSubstr("packages: {ROBOTS: ../elsewhere}"));
}

TEST_F(Outside, FilesOfOtherFoldersAreFoundByAnOption) {
  drone();
  const std::string cnoid = project("models/drone.body");
  fs::create_directories(folder() / "elsewhere/models");
  fs::rename(folder() / "drone.body", folder() / "elsewhere/models/drone.body");
  EXPECT_EQ(run(command, {"import", cnoid, "-o", "a", "--allow-unknown-devices"}).status, 2);
  const Outcome absent = run(command, {"import", cnoid, "-o", "a", "--search", "nowhere"});
  EXPECT_EQ(absent.status, 2);
  EXPECT_THAT(absent.err, HasSubstr("nowhere: error: the folder of --search isn't there"));
  EXPECT_FALSE(exists("a"));
  const Outcome found =
      run(command, {"import", cnoid, "-o", "a", "--search", ".", "--search", "elsewhere", "--allow-unknown-devices"});
  EXPECT_EQ(found.status, 4) << found.err;
  EXPECT_THAT(read_file(folder() / "a/drone.yaml"), HasSubstr("model: ../elsewhere/models/drone.body"));
}

TEST_F(Outside, RotorsAreInspected) {
  const std::string hopper = (fixtures / "models/hopper.wrl").string();
  const std::string text = done({"inspect", hopper}).out;
  EXPECT_THAT(text, ContainsRegex("\n  id  joint .* effort  rotor\n"));
  EXPECT_THAT(text, ContainsRegex("\n  0   HIP .* 2e-05 kg·m², gear 50: 0.05 kg·m²\n"));
  const nlohmann::json hip = done({"inspect", hopper, "--json"}).json()["joints"][0];
  EXPECT_EQ(hip["rotor"]["inertia"], 0.00002);
  EXPECT_EQ(hip["rotor"]["gear_ratio"], 50.0);
  EXPECT_NEAR(hip["rotor"]["inertia_at_joint"].get<double>(), 0.05, 1e-15);
  EXPECT_THAT(done({"inspect", (fixtures / "models/pendulum.urdf").string()}).out, Not(HasSubstr("rotor")));
}

TEST_F(Outside, TheSecondRigidBodyIsTheCauseOfAMissingMass) {
  const std::string body = write("twice.body",
                                 "format: ChoreonoidBody\nformat_version: 2.0\nname: twice\nlinks:\n"
                                 "  - { name: BASE, joint_type: fixed }\n  - name: ARM\n    parent: BASE\n"
                                 "    joint_type: revolute\n    elements:\n      RigidBody: { mass: 2 }\n"
                                 "      RigidBody: { center_of_mass: [ 0, 0, 1 ] }\n")
                               .string();
  const Outcome refused = run(command, {"inspect", body});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err,
              HasSubstr("twice.body:6: error: link 'ARM' moves but has no mass (its second RigidBody, of line "
                        "11, replaces the first, of line 10: write elements as a list"));
  EXPECT_THAT(refused.err, Not(HasSubstr("<inertial>")));
}

TEST_F(Outside, LinesOfControllersArePrintedAsTheyCome) {
  const std::string scenario = pendulum(MISBEHAVING, "chat").string();
  const Outcome told = rehearse({"record", scenario, "-o", "a.mcap", "--duration", "0.03"});
  EXPECT_EQ(told.status, 0) << told.err;
  EXPECT_THAT(told.err, HasSubstr("Pendulum/Swing: call 0\nPendulum/Swing: call 1\n"));
  EXPECT_THAT(told.out, Not(HasSubstr("call 0")));
  const Outcome quiet = rehearse({"record", scenario, "-o", "b.mcap", "--duration", "0.03", "--quiet"});
  EXPECT_EQ(quiet.status, 0);
  EXPECT_THAT(quiet.err, Not(HasSubstr("call")));
  const std::string some = done({"info", "b.mcap"}).out, all = done({"info", "b.mcap", "--full"}).out;
  EXPECT_THAT(some, ContainsRegex("  and [0-9]+ more; --full prints them all\n"));
  EXPECT_THAT(some, Not(HasSubstr("call 29\n")));
  EXPECT_THAT(all, HasSubstr("call 29\n"));
  EXPECT_THAT(all, Not(HasSubstr("more;")));
}

}  // namespace
}  // namespace rehearse::test
