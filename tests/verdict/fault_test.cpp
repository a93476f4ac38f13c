// The table of faults: each fault is made in a standing robot. The right level of a check must find it and blame the
// right part of the loop. The table is printed after all tests.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <rehearse/session.h>
#include <unistd.h>

#include <map>
#include <regex>
#include <string_view>

#include "mutilate.h"
#include "standing_robot.h"
#include "support/printed_by_name.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

enum class Broken { nothing, dropped_frame, missing_tick, stale_input };

struct Fault {
  const char* name;
  LevelState controller, plant, closed;  // the results of the levels
  Stage stage;
  const char* sentence;           // a part of the verdict
  const char* library = nullptr;  // of the changed controller
  std::optional<Edit> edit = {};
  Broken loop = Broken::nothing;
};
constexpr LevelState equal = LevelState::equal, differs = LevelState::differs, none = LevelState::not_compared;

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
      controller_fault("gain off by 0.1 % in the last 0.1 s", "StandWith_last_part"),
      {"uninitialised memory", differs, equal, differs, Stage::controller, "uninitialised memory",
       "StandWith_uninitialised"},
      {"an option off by 0.1 %", differs, equal, differs, Stage::controller, "the controller changed", nullptr,
       Edit{"scenario.yaml", "library: StandWith_none}", "library: StandWith_none, options: \"1.001\"}"}},
      {"a limit that a controller reads", equal, equal, differs, Stage::controller,
       "the controller depends on a change in sr1.urdf", nullptr,
       Edit{"sr1.urdf", R"(<limit lower="0" upper="2.61799")", R"(<limit lower="0" upper="2.61")"}},
      {"the no-delay mode entered", differs, equal, differs, Stage::controller, "its commands act one tick earlier",
       "StandWith_no_delay"},
      {"the no-delay mode entered in tick 300", differs, equal, differs, Stage::controller,
       "its commands act one tick earlier", "StandWith_no_delay_later"},
      {"the no-delay mode by the scenario", differs, equal, differs, Stage::controller,
       "the scenario changed: line 19: delay of controller 'SR1/Stand' is false, and was true", nullptr,
       Edit{"scenario.yaml", "library: StandWith_none", "library: StandWith_none, delay: false"}},
      {"another library in the scenario", differs, equal, differs, Stage::controller, "the controller changed", nullptr,
       Edit{"scenario.yaml", "library: StandWith_none", "library: StandWith_gain"}},
      {"a controller under another name", differs, differs, differs, Stage::controller,
       "the scenario changed: line 19: controller of body 'SR1': 'Standing' was named 'Stand'", nullptr,
       Edit{"scenario.yaml", "name: Stand,", "name: Standing,"}},
      {"a smaller time step", none, none, none, Stage::inputs,
       "the scenario's time step changed: it is 0.0008 s, and the golden's 0.001 s", nullptr,
       Edit{"scenario.yaml", "seed: 7", "seed: 7\ntime_step: 0.0008"}},
      {"a larger time step", none, none, none, Stage::inputs,
       "the scenario's time step changed: it is 0.002 s, and the golden's 0.001 s", nullptr,
       Edit{"scenario.yaml", "seed: 7", "seed: 7\ntime_step: 0.002"}},
      {"a shorter duration", equal, equal, equal, Stage::inputs,
       "the scenario's duration changed: it is 0.4 s, and the golden's 0.6 s; up to 0.399 s equal bit for bit", nullptr,
       Edit{"scenario.yaml", "duration: 0.6", "duration: 0.4"}},
      {"a longer duration", equal, equal, equal, Stage::inputs,
       "the scenario's duration changed: it is 0.7 s, and the golden's 0.6 s; up to 0.599 s equal bit for bit", nullptr,
       Edit{"scenario.yaml", "duration: 0.6", "duration: 0.7"}},
      {"another box in the world", equal, differs, differs, Stage::physics,
       "the scenario changed: line 6: body 'Box' is new", nullptr,
       Edit{"scenario.yaml",
            "bodies:", "bodies:\n  - {name: Box, box: {size: [1, 1, 1]}, mass: 1, position: [5, 5, 0.499]}"}},
      {"a floor without friction", equal, differs, differs, Stage::physics, "scenario.yaml changed", nullptr,
       Edit{"scenario.yaml", "friction: 1}", "friction: 0}"}},
      {"gravity off by 0.1 %", equal, differs, differs, Stage::physics, "scenario.yaml changed", nullptr,
       Edit{"scenario.yaml", "seed: 7", "seed: 7\ngravity: [0, 0, -9.8165]"}},
      {"another method of the solver", equal, differs, differs, Stage::physics, "scenario.yaml changed", nullptr,
       Edit{"scenario.yaml", "friction: 1}", "friction: 1, method: quick}"}},
      {"a robot placed 1 mm higher", equal, differs, differs, Stage::physics, "from tick 0 (0 s) on", nullptr,
       Edit{"scenario.yaml", "0.7135]", "0.7145]"}},
      {"a joint placed 0.1 deg aside", equal, differs, differs, Stage::physics, "from tick 0 (0 s) on", nullptr,
       Edit{"scenario.yaml", "RARM_ELBOW: -90 deg", "RARM_ELBOW: -89.9 deg"}},
      {"a push that nobody gave before", equal, differs, differs, Stage::physics, "scenario.yaml changed", nullptr,
       Edit{"scenario.yaml",
            "noise:", "pushes: [{body: SR1, link: WAIST, force: [1, 0, 0], from: 0.2, until: 0.21}]\nnoise:"}},
      {"a link's mass off by 1 g", equal, differs, differs, Stage::physics, "sr1.urdf changed", nullptr,
       Edit{"sr1.urdf", R"(<mass value="5.1"/>)", R"(<mass value="5.101"/>)"}},
      {"a centre of mass off by 1 mm", equal, differs, differs, Stage::physics, "sr1.urdf changed", nullptr,
       Edit{"sr1.urdf", "<origin xyz=\"0 -0.04 0\"/>\n      <mass value=\"5.1\"/>",
            "<origin xyz=\"0 -0.039 0\"/>\n      <mass value=\"5.1\"/>"}},
      {"a sensor's frame turned by 0.1 deg", equal, differs, differs, Stage::sensors, "sr1.urdf changed", nullptr,
       Edit{"sr1.urdf", R"(<sensor name="WaistIMU" type="imu">)",
            R"(<sensor name="WaistIMU" type="imu"><pose>0 0 0 0 0.0017453 0</pose>)"}},
      {"the seed of a sensor's noise", equal, differs, differs, Stage::sensors, "the random stream of the noise",
       nullptr, Edit{"scenario.yaml", "seed: 7", "seed: 8"}},
      {"one light off", equal, differs, differs, Stage::renderer, "watcher.urdf changed", nullptr,
       Edit{"watcher.urdf", "<pose>0 -1 1 0 0 0</pose><intensity>0.5<", "<pose>0 -1 1 0 0 0</pose><intensity>0<"}},
      {"a picture shifted by one pixel", equal, differs, differs, Stage::renderer, "watcher.urdf changed", nullptr,
       Edit{"watcher.urdf", "<pose>0 0 0 0 0 0</pose>", "<pose>0 0 0 0 0 0.0109</pose>"}},
      {"a frame dropped", equal, differs, differs, Stage::renderer, "missing", nullptr, {}, Broken::dropped_frame},
      {"a tick missing", equal, differs, differs, Stage::physics, "missing", nullptr, {}, Broken::missing_tick},
      {"an input delivered late",
       equal,
       equal,
       differs,
       Stage::inputs,
       "got other inputs than in the golden",
       nullptr,
       {},
       Broken::stale_input},
  };
}

/// The first code of the verdict on each fault; of all others it is that of a controller.
std::string_view code_of(const Fault& fault) {
  static const std::map<std::string_view, std::string_view> codes{
      {"uninitialised memory", "controller.unsteady"},
      {"a limit that a controller reads", "model.changed"},
      {"the no-delay mode by the scenario", "scenario.changed"},
      {"a controller under another name", "scenario.changed"},
      {"a smaller time step", "scenario.time_step_changed"},
      {"a larger time step", "scenario.time_step_changed"},
      {"a shorter duration", "scenario.duration_changed"},
      {"a longer duration", "scenario.duration_changed"},
      {"another box in the world", "scenario.changed"},
      {"a floor without friction", "scenario.changed"},
      {"gravity off by 0.1 %", "scenario.changed"},
      {"another method of the solver", "scenario.changed"},
      {"a robot placed 1 mm higher", "scenario.changed"},
      {"a joint placed 0.1 deg aside", "scenario.changed"},
      {"a push that nobody gave before", "scenario.changed"},
      {"a link's mass off by 1 g", "model.changed"},
      {"a centre of mass off by 1 mm", "model.changed"},
      {"a sensor's frame turned by 0.1 deg", "model.changed"},
      {"the seed of a sensor's noise", "noise.changed"},
      {"one light off", "model.changed"},
      {"a picture shifted by one pixel", "model.changed"},
      {"a frame dropped", "renderer.changed"},
      {"a tick missing", "physics.changed"},
      {"an input delivered late", "controller.inputs_changed"},
  };
  const auto found = codes.find(fault.name);
  return found == codes.end() ? "controller.changed" : found->second;
}

/// The results for each fault, for the table.
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
    fs::remove_all(certificates());
  }

  /// Proofs need a check that has simulated the golden, which has the same bytes in all tests.
  void certify_golden(const RecordOptions& original) const {
    CheckOptions options;
    options.controller = options.plant = false;
    options.certificates = certificates();
    options.run.libraries = original.libraries;
    const auto report = robot_.check(options, {record, run_plant, describe_plant});
    ASSERT_TRUE(report.ok()) << to_string(report.errors());
  }
  static fs::path certificates() { return fs::temp_directory_path() / fmt::format("rehearse_proofs_{}", getpid()); }
  void compare_with_proof(const CheckReport& simulated, CheckOptions options, const Simulation& simulation) const;
  void compare_with_samples(const CheckReport& whole, const CheckOptions& options, const Simulation& simulation) const;

  StandingRobot robot_;
};

/// What is proved of a fault must not change its verdict.
void Faults::compare_with_proof(const CheckReport& simulated, CheckOptions options,
                                const Simulation& simulation) const {
  const Fault& fault = GetParam();
  options.certificates = certificates();
  const auto report = robot_.check(options, simulation);
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  const auto without_proof = [](LevelState state) { return state == LevelState::proved ? LevelState::equal : state; };
  EXPECT_EQ(without_proof(report->controller), simulated.controller);
  EXPECT_EQ(without_proof(report->plant), simulated.plant) << report->not_proved;
  EXPECT_EQ(without_proof(report->closed), simulated.closed) << report->not_proved;
  EXPECT_EQ(report->verdict, simulated.verdict);
  EXPECT_EQ(report->codes, simulated.codes);
  EXPECT_EQ(report->horizon, simulated.horizon);
  EXPECT_FALSE(report->proved);
  ASSERT_TRUE(report->first);
  EXPECT_EQ(to_string(*report->first), to_string(*simulated.first));
  EXPECT_EQ(report->first->stage, simulated.first->stage);
  const bool same_world = fault.controller == differs && fault.plant == equal;
  EXPECT_EQ(report->plant == LevelState::proved, same_world) << report->not_proved;
  EXPECT_EQ(report->not_proved.empty(), same_world);
}

/// A golden with samples of the state gives the verdict of the whole golden, at most a sample later.
void Faults::compare_with_samples(const CheckReport& whole, const CheckOptions& options,
                                  const Simulation& simulation) const {
  constexpr std::int64_t period = 10;  // [ticks]
  const auto size = fs::file_size(robot_.file("golden.mcap"));
  EXPECT_THAT(robot_.keep_samples(100.0), ::testing::ElementsAre("/SR1/WaistGyro/imu"));  // the controller reads it
  EXPECT_LT(fs::file_size(robot_.file("golden.mcap")), size * 8 / 10);
  const auto report = robot_.check(options, simulation);
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_EQ(report->controller, whole.controller);
  EXPECT_EQ(report->plant, whole.plant);
  EXPECT_EQ(report->closed, whole.closed);
  EXPECT_THAT(report->verdict, HasSubstr(GetParam().sentence));
  ASSERT_TRUE(report->first);
  EXPECT_EQ(report->first->stage, whole.first->stage);
  EXPECT_GE(report->first->tick, whole.first->tick) << report->verdict;
  EXPECT_LT(report->first->tick, whole.first->tick + period) << report->verdict;
  if (whole.first->stage == Stage::controller) {
    EXPECT_EQ(report->first->tick, whole.first->tick) << report->verdict;
  }
}

/// A simulation loop that damages its recording.
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
  if (chance) original.libraries["Stand"] = fault.library;  // the recorded controller has the fault, too
  robot_.record_golden(original);
  certify_golden(original);

  if (fault.edit) robot_.apply(*fault.edit);
  CheckOptions options;
  if (fault.library) options.run.libraries["Stand"] = fault.library;
  const Simulation simulation{
      [&](const Scenario& of, const fs::path& trace, const RecordOptions& with) {
        return broken(record(of, trace, with), trace, fault.loop);
      },
      [&](const Scenario& of, const Trace& recording, const fs::path& trace, const PlantOptions& with) {
        return broken(run_plant(of, recording, trace, with), trace, fault.loop);
      },
      [&](const Scenario& of) {
        auto plant = describe_plant(of);
        if (plant && fault.loop != Broken::nothing) plant->emplace("the loop", "broken");
        return plant;
      },
      record_from};
  const auto report = robot_.check(options, simulation);
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_EQ(report->controller, fault.controller) << report->verdict;
  EXPECT_EQ(report->plant, fault.plant) << report->verdict;
  EXPECT_EQ(report->closed, fault.closed) << report->verdict;
  if (chance)  // the size of the difference is random, too: if it is within tolerance, the run doesn't repeat itself
    EXPECT_THAT(report->verdict, ::testing::AnyOf(HasSubstr(fault.sentence), HasSubstr("doesn't repeat itself")));
  else
    EXPECT_THAT(report->verdict, HasSubstr(fault.sentence));
  ASSERT_FALSE(report->codes.empty());
  if (!chance) {
    EXPECT_EQ(to_string(report->codes[0]), code_of(fault)) << report->verdict;
  }
  ASSERT_TRUE(report->first);
  EXPECT_EQ(report->first->stage, fault.stage) << report->verdict;
  if (!chance) {
    compare_with_proof(*report, options, simulation);
    compare_with_samples(*report, options, simulation);
  }
  rows().push_back(fmt::format("{:<36}{:<12}{:<9}{:<9}{:<12}tick {}, {} {}", fault.name, to_string(report->controller),
                               to_string(report->plant), to_string(report->closed), to_string(report->first->stage),
                               report->first->tick, report->first->channel, report->first->element));
}

}  // namespace
}  // namespace rehearse
