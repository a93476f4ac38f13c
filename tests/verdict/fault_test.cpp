// The table of faults: each is made in a robot that stands, and has to be found by the right level of a check and blamed
// on the right part of the loop. Printed when all have run.
#include <rehearse/check.h>
#include <rehearse/plant_run.h>
#include <rehearse/session.h>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <regex>

#include "mutilate.h"
#include "small_traces.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// A wall with a camera that looks at the robot, and two lamps.
constexpr const char* watcher_urdf = R"(<?xml version="1.0"?>
<robot name="Watcher">
  <link name="WALL"/>
  <gazebo reference="WALL">
    <light name="Lamp" type="point"><pose>0 1 1 0 0 0</pose><intensity>0.5</intensity></light>
    <light name="SecondLamp" type="point"><pose>0 -1 1 0 0 0</pose><intensity>0.5</intensity></light>
    <sensor name="Eye" type="camera">
      <pose>0 0 0 0 0 0</pose>
      <update_rate>20</update_rate>
      <camera><horizontal_fov>1.0471975511965976</horizontal_fov><image><width>96</width><height>72</height></image></camera>
    </sensor>
  </gazebo>
</robot>
)";

constexpr const char* scenario_yaml = R"(rehearse: 1
duration: 0.6
seed: 7
solver: {friction: 1}
bodies:
  - name: Floor
    box: {size: [10, 10, 0.2], color: [0.2, 0.4, 0.8]}
    fixed: true
    position: [0, 0, -0.1]
  - name: Watcher
    model: watcher.urdf
    position: [2, 0, 1]
    rotation: [0, 0, 180 deg]
  - name: SR1
    model: sr1.urdf
    position: [0, 0, 0.7135]
    joints: {RLEG_HIP_P: -2.1 deg, RLEG_KNEE: 4.50001 deg, RLEG_ANKLE_P: -2.40001 deg, LLEG_HIP_P: -2.1 deg,
             LLEG_KNEE: 4.50001 deg, LLEG_ANKLE_P: -2.40001 deg, RARM_ELBOW: -90 deg, LARM_ELBOW: -90 deg}
    controllers: [{name: Stand, library: StandWith_none}]
noise:
  - {sensor: SR1/WaistGyro, angular_velocity: {stddev: 0.001}}
cameras: [Watcher/Eye]
)";

/// A change of a text of the scratch folder.
struct Edit {
  const char* file;
  const char* from;
  const char* to;
};

enum class Broken { nothing, dropped_frame, missing_tick, stale_input };

struct Fault {
  const char* name;
  LevelState controller, plant, closed;  // what the levels have to say
  Stage stage;
  const char* sentence;            // a part of the verdict
  const char* library = nullptr;   // of the changed controller
  std::optional<Edit> edit = {};
  Broken loop = Broken::nothing;
};
void PrintTo(const Fault& fault, std::ostream* stream) { *stream << fault.name; }

constexpr LevelState equal = LevelState::equal, differs = LevelState::differs;

Fault controller_fault(const char* name, const char* library) {
  return {name, differs, equal, differs, Stage::controller, "the controller changed", library};
}

std::vector<Fault> faults() {
  return {
      controller_fault("gain off by 0.1 %", "StandWith_gain"),
      controller_fault("a sign", "StandWith_sign"),
      controller_fault("a delay of one tick", "StandWith_late"),
      controller_fault("two joints swapped", "StandWith_swapped"),
      controller_fault("a stale value kept", "StandWith_stale"),
      {"uninitialised memory", differs, equal, differs, Stage::controller, "uninitialised memory",
       "StandWith_uninitialised"},
      {"an option off by 0.1 %", differs, equal, differs, Stage::controller, "the controller changed", nullptr,
       Edit{"scenario.yaml", "library: StandWith_none}", "library: StandWith_none, options: \"1.001\"}"}},
      {"a limit that a controller reads", equal, equal, differs, Stage::controller,
       "the controller goes by what changed in sr1.urdf", nullptr,
       Edit{"sr1.urdf", R"(<limit lower="0" upper="2.61799")", R"(<limit lower="0" upper="2.61")"}},
      {"friction off by 1 %", equal, differs, differs, Stage::physics, "it is because of scenario.yaml", nullptr,
       Edit{"scenario.yaml", "friction: 1}", "friction: 0.99}"}},
      {"a link's mass off by 1 g", equal, differs, differs, Stage::physics, "it is because of sr1.urdf", nullptr,
       Edit{"sr1.urdf", R"(<mass value="5.1"/>)", R"(<mass value="5.101"/>)"}},
      {"a sensor's frame turned by 0.1 deg", equal, differs, differs, Stage::sensors, "it is because of sr1.urdf",
       nullptr,
       Edit{"sr1.urdf", R"(<sensor name="WaistIMU" type="imu">)",
            R"(<sensor name="WaistIMU" type="imu"><pose>0 0 0 0 0.0017453 0</pose>)"}},
      {"the seed of a sensor's noise", equal, differs, differs, Stage::sensors, "the random stream of the noise",
       nullptr, Edit{"scenario.yaml", "seed: 7", "seed: 8"}},
      {"one light off", equal, differs, differs, Stage::renderer, "it is because of watcher.urdf", nullptr,
       Edit{"watcher.urdf", "<pose>0 -1 1 0 0 0</pose><intensity>0.5<", "<pose>0 -1 1 0 0 0</pose><intensity>0<"}},
      {"a picture shifted by one pixel", equal, differs, differs, Stage::renderer, "it is because of watcher.urdf",
       nullptr, Edit{"watcher.urdf", "<pose>0 0 0 0 0 0</pose>", "<pose>0 0 0 0 0 0.0109</pose>"}},
      {"a frame dropped", equal, differs, differs, Stage::renderer, "missing", nullptr, {}, Broken::dropped_frame},
      {"a tick missing", equal, differs, differs, Stage::physics, "missing", nullptr, {}, Broken::missing_tick},
      {"an input delivered late", equal, equal, differs, Stage::inputs, "fed with something else", nullptr, {},
       Broken::stale_input},
  };
}

/// What was found of each, for the table.
std::vector<std::string>& rows() {
  static std::vector<std::string> all;
  return all;
}

class Faults : public ::testing::TestWithParam<Fault> {
 protected:
  static void TearDownTestSuite() {
    fmt::print("\n{:<36}{:<12}{:<9}{:<9}{:<12}{}\n", "fault", "controller", "plant", "closed", "blamed", "first");
    for (const std::string& row : rows()) fmt::print("{}\n", row);
    fmt::print("\n");
    rows().clear();
  }

  Faults() {
    setenv("REHEARSE_CONTROLLER_PATH", VERDICT_CONTROLLERS, 1);
    write("watcher.urdf", watcher_urdf);
    write("scenario.yaml", scenario_yaml);
    std::ifstream sr1(FIXTURES_DIR "/models/sr1.urdf", std::ios::binary);
    write("sr1.urdf", {std::istreambuf_iterator<char>(sr1), {}});
  }

  void write(const std::string& file, const std::string& text) const {
    std::ofstream(folder_ / file, std::ios::binary) << text;
  }
  void apply(const Edit& edit) const {
    std::ifstream stream(folder_ / edit.file, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    const std::size_t at = text.find(edit.from);
    ASSERT_NE(at, std::string::npos) << edit.from << " is not in " << edit.file;
    write(edit.file, text.replace(at, std::string(edit.from).size(), edit.to));
  }
  Scenario scenario() const {
    auto loaded = Scenario::load(folder_ / "scenario.yaml");
    EXPECT_TRUE(loaded.ok()) << to_string(loaded.errors());
    return *std::move(loaded);
  }

  testing::TemporaryFolder folder_;
};

/// A loop that breaks what it records.
template <class Made>
Result<Made> broken(Result<Made> made, const fs::path& trace, Broken how) {
  if (!made || how == Broken::nothing) return made;
  std::optional<std::vector<std::byte>> before;
  int pictures = 0;
  const auto change = [&](const mcap::Message& message) -> std::optional<std::vector<std::byte>> {
    constexpr std::uint64_t tick = 1000000;  // [ns]
    const std::string& topic = message.channel->topic;
    if (how == Broken::missing_tick && message.log_time == 300 * tick) return std::nullopt;
    if (how == Broken::dropped_frame && topic == "/Watcher/Eye/image" && ++pictures == 5) return std::nullopt;
    if (how != Broken::stale_input || topic != "/SR1/Stand/input/joints") return testing::untouched(message);
    auto now = testing::untouched(message);
    if (message.log_time == 300 * tick) std::swap(*now, *before);
    before = testing::untouched(message);
    return now;
  };
  if (auto done = testing::mutilate(trace, change); !done) return done.errors();
  return made;
}

INSTANTIATE_TEST_SUITE_P(Of, Faults, ::testing::ValuesIn(faults()), [](const auto& of) {
  return std::regex_replace(std::string(of.param.name), std::regex("[^A-Za-z0-9]+"), "_");
});

TEST_P(Faults, AreFoundAndBlamedOnThePartThatHasThem) {
  const Fault& fault = GetParam();
#if defined(__SANITIZE_ADDRESS__)
  if (fault.name == std::string("uninitialised memory"))
    GTEST_SKIP() << "the sanitizer fills fresh memory with the same bytes each time";
#endif
  const bool chance = fault.name == std::string("uninitialised memory");
  RecordOptions original;
  if (chance) original.libraries["Stand"] = fault.library;  // it was always like this
  const auto made = record(scenario(), folder_ / "golden.mcap", original);
  ASSERT_TRUE(made.ok() && !made->failure) << to_string(made.ok() ? Diagnostics{*made->failure} : made.errors());

  if (fault.edit) apply(*fault.edit);
  CheckOptions options;
  if (fault.library) options.run.libraries["Stand"] = fault.library;
  const Simulation simulation{
      [&](const Scenario& of, const fs::path& trace, const RecordOptions& with) {
        return broken(record(of, trace, with), trace, fault.loop);
      },
      [&](const Scenario& of, const Trace& recording, const fs::path& trace, const PlantOptions& with) {
        return broken(run_plant(of, recording, trace, with), trace, fault.loop);
      }};
  const auto report = check_scenario(scenario(), folder_ / "golden.mcap", folder_ / "actual.mcap", options, simulation);
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_EQ(report->controller, fault.controller) << report->verdict;
  EXPECT_EQ(report->plant, fault.plant) << report->verdict;
  EXPECT_EQ(report->closed, fault.closed) << report->verdict;
  if (chance)  // how far off it is is chance too: within tolerance, the run is one that doesn't repeat itself
    EXPECT_THAT(report->verdict, ::testing::AnyOf(HasSubstr(fault.sentence), HasSubstr("doesn't repeat itself")));
  else
    EXPECT_THAT(report->verdict, HasSubstr(fault.sentence));
  ASSERT_TRUE(report->first);
  EXPECT_EQ(report->first->stage, fault.stage) << report->verdict;
  rows().push_back(fmt::format("{:<36}{:<12}{:<9}{:<9}{:<12}tick {}, {} {}", fault.name, to_string(report->controller),
                               to_string(report->plant), to_string(report->closed), to_string(report->first->stage),
                               report->first->tick, report->first->channel, report->first->element));
}

}  // namespace
}  // namespace rehearse
