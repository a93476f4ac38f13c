// The table of faults: each fault is made in a standing robot. The right level of a check must find it and blame the
// right part of the loop. The table is printed after all tests.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <rehearse/session.h>
#include <unistd.h>

#include <algorithm>
#include <regex>
#include <string_view>

#include "core/compare/divergence_text.h"
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
  VerdictCode code;               // of the first sentence
  const char* changed = "";       // the changed key in that sentence; empty: it names none
  const char* library = nullptr;  // of the changed controller
  std::optional<Edit> edit = {};
  Broken loop = Broken::nothing;
};
constexpr LevelState equal = LevelState::equal, differs = LevelState::differs, none = LevelState::not_compared;

Fault controller_fault(const char* name, const char* library) {
  return {name, differs, equal, differs, Stage::controller, VerdictCode::controller_changed, "", library};
}

/// A fault of the world by a change of a file.
Fault world_fault(const char* name, Stage stage, const char* changed, const Edit& edit) {
  const bool is_scenario = edit.file == std::string("scenario.yaml");
  return {name,    equal,   differs,
          differs, stage,   is_scenario ? VerdictCode::scenario_changed : VerdictCode::model_changed,
          changed, nullptr, edit};
}

std::vector<Fault> faults() {
  using enum VerdictCode;
  using enum Stage;
  return {
      controller_fault("gain off by 0.1 %", "StandWith_gain"),
      controller_fault("a sign", "StandWith_sign"),
      controller_fault("a delay of one tick", "StandWith_late"),
      controller_fault("two joints swapped", "StandWith_swapped"),
      controller_fault("a stale value kept", "StandWith_stale"),
      controller_fault("gain off by 0.1 % in the last 0.1 s", "StandWith_last_part"),
      {"uninitialised memory", differs, equal, differs, controller, controller_unsteady, "", "StandWith_uninitialised"},
      {"an option off by 0.1 %", differs, equal, differs, controller, controller_changed, "", nullptr,
       Edit{"scenario.yaml", "library: StandWith_none}", "library: StandWith_none, options: \"1.001\"}"}},
      {"a limit that a controller reads", equal, equal, differs, controller, model_changed,
       "joint RLEG_KNEE/limit/upper is 2.61, was 2.61799", nullptr,
       Edit{"sr1.urdf", R"(<limit lower="0" upper="2.61799")", R"(<limit lower="0" upper="2.61")"}},
      controller_fault("the no-delay mode entered", "StandWith_no_delay"),
      controller_fault("the no-delay mode entered in tick 300", "StandWith_no_delay_later"),
      {"the no-delay mode by the scenario", differs, equal, differs, controller, scenario_changed,
       "line 19: delay of controller 'SR1/Stand' is false, and was true", nullptr,
       Edit{"scenario.yaml", "library: StandWith_none", "library: StandWith_none, delay: false"}},
      {"another library in the scenario", differs, equal, differs, controller, controller_changed, "", nullptr,
       Edit{"scenario.yaml", "library: StandWith_none", "library: StandWith_gain"}},
      {"a controller under another name", differs, differs, differs, controller, scenario_changed,
       "line 19: controller of body 'SR1': 'Standing' was named 'Stand'", nullptr,
       Edit{"scenario.yaml", "name: Stand,", "name: Standing,"}},
      {"a smaller time step", none, none, none, inputs, time_step_changed, "it is 0.0008 s, and the golden's 0.001 s",
       nullptr, Edit{"scenario.yaml", "seed: 7", "seed: 7\ntime_step: 0.0008"}},
      {"a larger time step", none, none, none, inputs, time_step_changed, "it is 0.002 s, and the golden's 0.001 s",
       nullptr, Edit{"scenario.yaml", "seed: 7", "seed: 7\ntime_step: 0.002"}},
      {"a shorter duration", equal, equal, equal, inputs, duration_changed, "it is 0.4 s, and the golden's 0.6 s",
       nullptr, Edit{"scenario.yaml", "duration: 0.6", "duration: 0.4"}},
      {"a longer duration", equal, equal, equal, inputs, duration_changed, "it is 0.7 s, and the golden's 0.6 s",
       nullptr, Edit{"scenario.yaml", "duration: 0.6", "duration: 0.7"}},
      {"another box in the world", equal, differs, differs, physics, scenario_changed, "line 6: body 'Box' is new",
       nullptr,
       Edit{"scenario.yaml",
            "bodies:", "bodies:\n  - {name: Box, box: {size: [1, 1, 1]}, mass: 1, position: [5, 5, 0.499]}"}},
      world_fault("a floor without friction", physics, "solver/friction is 0, was 1",
                  {"scenario.yaml", "friction: 1}", "friction: 0}"}),
      world_fault("gravity off by 0.1 %", physics, "gravity is [0, 0, -9.8165], and is new",
                  {"scenario.yaml", "seed: 7", "seed: 7\ngravity: [0, 0, -9.8165]"}),
      world_fault("another method of the solver", physics, "solver/method is quick, and is new",
                  {"scenario.yaml", "friction: 1}", "friction: 1, method: quick}"}),
      world_fault("a robot placed 1 mm higher", physics, "bodies/SR1/position is [0, 0, 0.7145], was [0, 0, 0.7135]",
                  {"scenario.yaml", "0.7135]", "0.7145]"}),
      world_fault("a joint placed 0.1 deg aside", physics, "bodies/SR1/joints/RARM_ELBOW is -89.9 deg, was -90 deg",
                  {"scenario.yaml", "RARM_ELBOW: -90 deg", "RARM_ELBOW: -89.9 deg"}),
      world_fault("a push that nobody gave before", physics, "pushes is new",
                  {"scenario.yaml",
                   "noise:", "pushes: [{body: SR1, link: WAIST, force: [1, 0, 0], from: 0.2, until: 0.21}]\nnoise:"}),
      world_fault("a link's mass off by 1 g", physics, "/inertial/mass/value is 5.101, was 5.1",
                  {"sr1.urdf", R"(<mass value="5.1"/>)", R"(<mass value="5.101"/>)"}),
      world_fault("a centre of mass off by 1 mm", physics, "/inertial/origin/xyz is 0 -0.039 0, was 0 -0.04 0",
                  {"sr1.urdf", "<origin xyz=\"0 -0.04 0\"/>\n      <mass value=\"5.1\"/>",
                   "<origin xyz=\"0 -0.039 0\"/>\n      <mass value=\"5.1\"/>"}),
      world_fault("a sensor's frame turned by 0.1 deg", sensors,
                  "/sensor WaistIMU/pose is 0 0 0 0 0.0017453 0, and is new",
                  {"sr1.urdf", R"(<sensor name="WaistIMU" type="imu">)",
                   R"(<sensor name="WaistIMU" type="imu"><pose>0 0 0 0 0.0017453 0</pose>)"}),
      {"the seed of a sensor's noise", equal, differs, differs, sensors, noise_changed,
       "with the golden's seed 7 instead of 8, the world agrees", nullptr, Edit{"scenario.yaml", "seed: 7", "seed: 8"}},
      world_fault(
          "one light off", renderer, "gazebo WALL/light SecondLamp/intensity is 0, was 0.5",
          {"watcher.urdf", "<pose>0 -1 1 0 0 0</pose><intensity>0.5<", "<pose>0 -1 1 0 0 0</pose><intensity>0<"}),
      world_fault("a picture shifted by one pixel", renderer,
                  "gazebo WALL/sensor Eye/pose is 0 0 0 0 0 0.0109, was 0 0 0 0 0 0",
                  {"watcher.urdf", "<pose>0 0 0 0 0 0</pose>", "<pose>0 0 0 0 0 0.0109</pose>"}),
      {"a frame dropped", equal, differs, differs, renderer, renderer_changed, "", nullptr, {}, Broken::dropped_frame},
      {"a tick missing", equal, differs, differs, physics, physics_changed, "", nullptr, {}, Broken::missing_tick},
      {"an input delivered late",
       equal,
       equal,
       differs,
       inputs,
       controller_inputs_changed,
       "",
       nullptr,
       {},
       Broken::stale_input},
  };
}

/// The line of the first character that an edit changes; "" for an edit of another kind.
std::string place_of(const Fault& fault) {
  const bool names_a_key = fault.code == VerdictCode::model_changed || fault.plant == differs;
  const bool is_structure = std::string_view(fault.changed).starts_with("line ");
  if (!fault.edit || !names_a_key || is_structure || fault.code == VerdictCode::noise_changed) return "";
  const std::string text = fault.edit->file == std::string("scenario.yaml") ? standing_yaml
                           : fault.edit->file == std::string("watcher.urdf")
                               ? watcher_urdf
                               : test::read_file(FIXTURES_DIR "/models/sr1.urdf");
  const std::string_view from = fault.edit->from, to = fault.edit->to;
  const auto common = static_cast<std::size_t>(std::ranges::mismatch(from, to).in1 - from.begin());
  const std::size_t at = text.find(from) + common;
  const bool is_new_line = common < to.size() && to[common] == '\n';
  return fmt::format("{}:{} (", fault.edit->file,
                     1 + std::ranges::count(text.substr(0, at), '\n') + (is_new_line ? 1 : 0));
}

/// The first difference on the level that the first sentence reports, and the worst one of its channel.
std::pair<std::optional<Divergence>, std::optional<Divergence>> reported_by(const CheckReport& report,
                                                                            const Fault& fault) {
  const bool is_structure = std::string_view(fault.changed).starts_with("line ");
  if (report.controller == differs && !is_structure) return {report.replay->beyond, report.replay->worst};
  const auto& comparison = report.plant == differs && !is_structure ? report.plant_comparison : report.comparison;
  if (!comparison || !comparison->first) return {report.first, std::nullopt};
  const auto worst = worst_of_channel(*comparison, *comparison->first);
  const bool is_measured = worst && worst->tolerance > 0.0;  // beside exact numbers, the first one is reported
  return {comparison->first, is_measured ? worst : comparison->first};
}

/// The code, the changed key and the numbers of the first sentence.
void expect_first_sentence(const CheckReport& report, const Fault& fault) {
  ASSERT_FALSE(report.verdict.empty());
  const VerdictPart& said = report.verdict.parts()[0];
  EXPECT_EQ(to_string(said.code), to_string(fault.code)) << said.sentence;
  EXPECT_THAT(said.sentence, HasSubstr(fault.changed));
  EXPECT_THAT(said.sentence, HasSubstr(place_of(fault)));
  const auto [first, worst] = reported_by(report, fault);
  std::smatch found;
  if (std::regex_search(said.sentence, found, std::regex("(from|differs at) tick ([0-9]+)"))) {
    ASSERT_TRUE(first) << said.sentence;
    EXPECT_EQ(std::stoll(found[2]), first->tick) << said.sentence;
  }
  const std::regex worst_number("worst .*?([-+.e0-9]+) [^ ]+ \\([^ ]+ times\\) at tick ([0-9]+)");
  if (!std::regex_search(said.sentence, found, worst_number)) return;
  ASSERT_TRUE(worst) << said.sentence;
  EXPECT_NEAR(std::stod(found[1]), worst->judged(), 0.01 * worst->judged()) << said.sentence;
  EXPECT_EQ(std::stoll(found[2]), worst->tick) << said.sentence;
}

/// The results for each fault, for the table.
std::vector<std::string>& rows() {
  static std::vector<std::string> all;
  return all;
}

class Faults : public ::testing::TestWithParam<Fault> {
 protected:
  static void TearDownTestSuite() {
    fmt::print("\n{:<38}{:<14}{:<14}{:<14}{:<12}{:<32}{}\n", "fault", "controller", "plant", "closed", "blamed",
               "first sentence", "first");
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
  EXPECT_EQ(report->verdict.text(), simulated.verdict.text());
  EXPECT_EQ(report->verdict.codes(), simulated.verdict.codes());
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
  EXPECT_EQ(report->verdict.codes(), whole.verdict.codes()) << report->verdict.text();
  EXPECT_THAT(report->verdict.text(), HasSubstr(GetParam().changed));
  ASSERT_TRUE(report->first);
  EXPECT_EQ(report->first->stage, whole.first->stage);
  EXPECT_GE(report->first->tick, whole.first->tick) << report->verdict.text();
  EXPECT_LT(report->first->tick, whole.first->tick + period) << report->verdict.text();
  if (whole.first->stage == Stage::controller) {
    EXPECT_EQ(report->first->tick, whole.first->tick) << report->verdict.text();
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
  REHEARSE_TRY(testing::mutilate(trace, change));
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
  EXPECT_EQ(report->controller, fault.controller) << report->verdict.text();
  EXPECT_EQ(report->plant, fault.plant) << report->verdict.text();
  EXPECT_EQ(report->closed, fault.closed) << report->verdict.text();
  if (chance)  // the size of the difference is random, too: if it is within tolerance, the run doesn't repeat itself
    EXPECT_THAT(report->verdict.codes(),
                ::testing::Contains(::testing::AnyOf(fault.code, VerdictCode::golden_not_certified)));
  else
    expect_first_sentence(*report, fault);
  ASSERT_TRUE(report->first);
  EXPECT_EQ(report->first->stage, fault.stage) << report->verdict.text();
  if (!chance) {
    compare_with_proof(*report, options, simulation);
    compare_with_samples(*report, options, simulation);
  }
  rows().push_back(fmt::format("{:<38}{:<14}{:<14}{:<14}{:<12}{:<32}tick {}, {} {}", fault.name,
                               to_string(report->controller), to_string(report->plant), to_string(report->closed),
                               to_string(report->first->stage), report->verdict.code(), report->first->tick,
                               report->first->channel, report->first->element));
}

}  // namespace
}  // namespace rehearse
