// Names in `expect` and `tolerances` that no run of a scenario can have, and names that a run may record or not.
#include "core/check/unknown_series.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>

#include "small_traces.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::SmallTrace;
using testing::TemporaryFolder;

/// A robot with the link BASE, the joint KNEE, the force sensor Foot, a gyro and a camera that are off, and the
/// controller Pd.
class UnknownSeries : public ::testing::Test {
 protected:
  UnknownSeries() {
    run_.ticks = {{0}, {1}};
    auto model = std::make_shared<Model>();
    model->links.resize(2);
    model->links[0].name = "BASE";
    model->links[1].name = "SHIN";
    model->links[1].joint.name = "KNEE";
    const auto device = [](const char* name, DeviceKind kind) {
      Device made;
      made.name = name;
      made.kind = std::move(kind);
      return made;
    };
    model->devices = {device("Foot", ForceSensor()), device("Gyro", Gyro()), device("Eye", Camera())};
    ScenarioBody robot;
    robot.name = "Robot";
    robot.model = std::move(model);
    robot.controllers.resize(1);
    robot.controllers[0].name = "Pd";
    scenario_.bodies = {robot};
  }
  /// What is said of the name in an expectation; of a tolerance the same must be said.
  std::string said_of(const std::string& name) {
    const Trace trace = run_.load(folder_ / "run.mcap");
    const Trace* traces[] = {&trace};
    scenario_.expectations = {Expectation()};
    scenario_.expectations[0].pattern = name;
    scenario_.expectations[0].place = {"run.yaml", 7, 3};
    scenario_.tolerances.clear();
    const std::string said = to_string(unknown_series(scenario_, traces));
    scenario_.expectations.clear();
    scenario_.tolerances = {ToleranceRule()};
    scenario_.tolerances[0].channel = name;
    scenario_.tolerances[0].place = {"run.yaml", 7, 3};
    EXPECT_EQ(to_string(unknown_series(scenario_, traces)), said) << name;
    return said;
  }

  TemporaryFolder folder_;
  SmallTrace run_;
  Scenario scenario_;
};

TEST_F(UnknownSeries, AreToldWithTheLineAndTheNearestNames) {
  EXPECT_THAT(said_of("Robot/BAS/position/z"),
              HasSubstr("run.yaml:7:3: error: no run of this scenario has a series 'Robot/BAS/position/z' (the nearest "
                        "are Robot/BASE/position/z, "));
}

TEST_F(UnknownSeries, AreThoseOfUnknownBodiesPartsAndElements) {
  for (const char* name :
       {"Robt/BASE/position/z", "Robot/BASE/positon/z", "Robot/KNEE/qq", "Robot/Foot/forc/z", "Robot/SHIN/position/z",
        "Robot/KNEE", "Robot/Pd/outputs/KNEE/u", "Robot/Pd/output/KNE/u", "position/z"})
    EXPECT_THAT(said_of(name), HasSubstr("no run of this scenario")) << name;
}

TEST_F(UnknownSeries, AreNotThoseThatARunMayHave) {
  for (const char* name :
       {"Robot/BASE/position/z", "Robot/Gyro/angular_velocity/x", "Robot/Eye/image", "Robot/Pd/variable/phase",
        "Robot/Pd/output/Foot/state", "Robot/*/qq", "contacts/Robot/BASE/Floor/Floor", "limits/Robot/KNEE/u",
        "controller_results/0", "events/Robot/Pd"})
    EXPECT_THAT(said_of(name), IsEmpty()) << name;
}

}  // namespace
}  // namespace rehearse
