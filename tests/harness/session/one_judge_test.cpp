// One judge: a change of commands gets the same judgement in a comparison of two recordings, in a replay, and in the
// replay of a log, by every rule of tolerances.
#include <rehearse/cdr.h>
#include <rehearse/check.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>

#include "logs/robot_log/log_replay.h"
#include "mutilate.h"
#include "runs.h"
#include "support/printed_by_name.h"

namespace rehearse {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* joints = "/Rig/C/output/joints";
constexpr const char* pose = "/Box/T/output/Box/pose";

/// A change of the golden; the controllers stay as they are.
struct Change {
  int later = 0;                  // ticks by which the effort steps later in the golden
  double effort = 0.0;            // is added to the effort [N·m]
  double scaled = 1.0;            // factor of all four numbers of the orientation
  int refused = 0;                // number of ticks, from tick 20 on, in which control() returns false in the golden
  double turned = 0.0;            // angle by which the orientation is turned about z [rad]
  mcap::StringMap metadata = {};  // of all channels
};

struct Row {
  std::string name;
  Change change;
  std::string rules;  // a list in YAML
  /// All differences are within tolerance.
  bool within = false;
  bool is_equal = false;
  /// Logs have neither poses nor metadata.
  bool has_log = true;
};

std::ostream& operator<<(std::ostream& to, const Row& row) { return to << row.name; }

constexpr double step = 0.1;  // the commanded effort from tick 20 on [N·m]

template <class Message, class Edit>
std::vector<std::byte> edited(const mcap::Message& message, const Edit& edit) {
  CdrReader reader(message.data);
  Message content;
  EXPECT_TRUE(msg::decode(reader, content));
  edit(content);
  CdrWriter writer;
  msg::encode(content, writer);
  const auto bytes = writer.bytes();
  return {bytes.begin(), bytes.end()};
}

std::vector<std::byte> changed(const Change& change, const mcap::Message& message) {
  if (message.channel->topic == joints)
    return edited<msg::JointState>(message, [&](msg::JointState& state) {
      const auto tick = static_cast<int>(message.log_time / 1'000'000);
      if (change.later != 0) state.effort.at(0) = tick >= 20 + change.later ? step : 0.0;
      state.effort.at(0) += change.effort;
    });
  if (message.channel->topic == "/tick" && change.refused > 0)
    return edited<msg::Tick>(message, [&](msg::Tick& tick) {
      if (tick.tick >= 20 && tick.tick < 20 + change.refused) tick.controller_results.at(0) = false;
    });
  if (message.channel->topic == pose)
    return edited<msg::PoseStamped>(message, [&](msg::PoseStamped& at) {
      auto& q = at.pose.orientation;
      if (change.turned != 0.0) q = {0.0, 0.0, std::sin(change.turned / 2.0), std::cos(change.turned / 2.0)};
      for (double* number : {&q.x, &q.y, &q.z, &q.w}) *number *= change.scaled;
    });
  return *testing::untouched(message);
}

std::string rule(const std::string& channel, const std::string& more) {
  return "[{channel: \"" + channel + "\", " + more + "}]";
}

class OneJudge : public RunTest, public ::testing::WithParamInterface<Row> {
 protected:
  static std::string scenario(const std::string& rules) {
    return "rehearse: 1\nduration: 0.06\ncameras: none\ntolerances: " + rules +
           "\nbodies:\n  - name: Rig\n    model: rig.urdf\n    controllers: [" + behaviour("C", "step 0.1 20") +
           "]\n  - name: Box\n    box: {size: [1, 1, 1]}\n    mass: 2\n    position: [9, 0, 0]\n    controllers: [" +
           behaviour("T", "teleport") + "]\n";
  }

  /// The run is run.mcap, the changed golden golden.mcap.
  void make(const Row& row) {
    record_run(scenario(row.rules));
    std::filesystem::copy_file(path("run.mcap"), path("golden.mcap"),
                               std::filesystem::copy_options::overwrite_existing);
    const auto done = testing::mutilate(
        path("golden.mcap"), [&](const mcap::Message& message) { return std::optional(changed(row.change, message)); },
        {}, {}, row.change.metadata);
    ASSERT_TRUE(done) << to_string(done.errors());
    rules_ = load(scenario(row.rules)).tolerances;
  }

  Comparison closed() const {
    CompareOptions what;
    what.stages = {Stage::controller};
    auto comparison = compare(path("golden.mcap"), path("run.mcap"), rules_, what);
    EXPECT_TRUE(comparison) << to_string(comparison.errors());
    return comparison ? *std::move(comparison) : Comparison();
  }

  ReplayReport controller(ReplayOptions options = {}) const {
    options.tolerances = rules_;
    auto report = replay(path("golden.mcap"), options);
    EXPECT_TRUE(report) << to_string(report.errors());
    return report ? *std::move(report) : ReplayReport();
  }

  LogReplayReport log(const std::string& rules, double from = 0.0) const {
    write(
        "map.yaml",
        std::string("rehearse_map: 1\ntime_step: 0.001\nbody: Rig\ncontroller: {name: C, options: \"step 0.1 20\"}\n") +
            "joints: /Rig/joints\ncommands: " + joints + "\ntolerances: " + rules + "\n");
    LogReplayOptions options;
    options.controller = "Behaviours";
    options.model = path("rig.urdf");
    options.map = path("map.yaml");
    options.from = mcap::TimeBound{static_cast<std::uint64_t>(std::llround(from * 1e9))};
    auto report = replay_log(path("golden.mcap"), path("log.mcap"), options);
    EXPECT_TRUE(report) << to_string(report.errors());
    return report ? *std::move(report) : LogReplayReport();
  }

  std::vector<ToleranceRule> rules_;
};

std::string text_of(const std::optional<Divergence>& place) { return place ? to_string(*place) : "none"; }

TEST_P(OneJudge, GivesTheSameJudgementOnAllLevels) {
  const Row& row = GetParam();
  make(row);
  const Comparison together = closed();
  EXPECT_EQ(together.within, row.within) << text_of(together.first);
  EXPECT_EQ(together.equal, row.is_equal) << text_of(together.first_bit);
  const ReplayReport alone = controller();
  EXPECT_EQ(alone.within(), row.within) << text_of(alone.beyond);
  EXPECT_EQ(alone.equal(), row.is_equal);
  EXPECT_EQ(text_of(alone.beyond), text_of(together.first));
  EXPECT_EQ(text_of(alone.first), text_of(together.first_bit));
  EXPECT_EQ(alone.values_different, together.differing);
  if (!row.has_log) return;
  // without a rule, a log's tolerance follows from the range of its commands; here the default of recordings is stated
  const LogReplayReport logged = log(row.rules == "[]" ? rule("*", "atol: 0.001") : row.rules);
  EXPECT_EQ(logged.within(), row.within) << text_of(logged.beyond);
  EXPECT_EQ(text_of(logged.beyond), text_of(together.first));
  EXPECT_EQ(text_of(logged.first), text_of(together.first_bit));
  EXPECT_EQ(logged.values_different, together.differing);
}

const std::string u = "Rig/C/output/*";
const std::string result = "controller_results/0";
const std::string orientation = "Box/T/output/*/orientation/*";
constexpr double turn = 2.0 * M_PI;
constexpr bool no_log = false;

INSTANTIATE_TEST_SUITE_P(
    Rules, OneJudge,
    ::testing::Values(
        Row{"Nothing", {}, "[]", true, true}, Row{"EarlyWithoutARule", {.later = 2}, "[]", false},
        Row{"EarlyWithinLead", {.later = 2}, rule(u, "atol: 1.0e-6, lead: 0.003, lag: 0.003"), true},
        Row{"EarlyAtLead", {.later = 2}, rule(u, "atol: 1.0e-6, lead: 0.002"), true},
        Row{"EarlyBeyondLead", {.later = 2}, rule(u, "atol: 1.0e-6, lead: 0.001, lag: 0.003"), false},
        Row{"LateWithinLag", {.later = -2}, rule(u, "atol: 1.0e-6, lag: 0.002"), true},
        Row{"LateBeyondLag", {.later = -3}, rule(u, "atol: 1.0e-6, lead: 0.003, lag: 0.002"), false},
        Row{"OffTheEnvelope", {.later = 2, .effort = 1e-3}, rule(u, "atol: 1.0e-6, lead: 0.003, lag: 0.003"), false},
        Row{"NearTheEnvelope", {.later = 2, .effort = 1e-7}, rule(u, "atol: 1.0e-6, lead: 0.003, lag: 0.003"), true},
        Row{"WithinAtol", {.effort = 0.01}, rule(u, "atol: 0.011"), true},
        Row{"BeyondAtol", {.effort = 0.01}, rule(u, "atol: 0.009"), false},
        Row{"WithinRtol", {.effort = 0.01}, rule(u, "atol: 0, rtol: 0.1"), true},
        Row{"BeyondRtol", {.effort = 0.01}, rule(u, "atol: 0, rtol: 0.09"), false},
        Row{"NoNumber", {.effort = std::numeric_limits<double>::quiet_NaN()}, rule(u, "atol: 9"), false},
        Row{"ATurnOfWhatWraps", {.effort = turn, .metadata = {{"wrap:SHOULDER/u", "true"}}}, "[]", true, false, no_log},
        Row{"ATurnOfWhatDoesNotWrap", {.effort = turn}, "[]", false},
        Row{"AHalfTurnOfWhatWraps",
            {.effort = turn / 2, .metadata = {{"wrap:SHOULDER/u", "true"}}},
            "[]",
            false,
            false,
            no_log},
        Row{"ALateTurnOfWhatWraps",
            {.later = -2, .effort = turn, .metadata = {{"wrap:SHOULDER/u", "true"}}},
            rule(u, "atol: 1.0e-6, lag: 0.002"),
            true,
            false,
            no_log},
        Row{"TheSameOrientation", {.scaled = -1.0}, "[]", true, false, no_log},
        Row{"AnotherOrientation", {.turned = 0.001}, "[]", false, false, no_log},
        Row{"AnOrientationWithinItsAngle",
            {.scaled = -1.0, .turned = 0.001},
            rule(orientation, "atol: 0.0011"),
            true,
            false,
            no_log},
        Row{"AnOrientationBeyondItsAngle", {.turned = 0.001}, rule(orientation, "atol: 0.0009"), false, false, no_log},
        Row{"AResultOfControlWithoutARule", {.refused = 3}, "[]", false, false, no_log},
        Row{"AResultOfControlWithinItsTicks", {.refused = 3}, rule(result, "ticks: 3"), true, false, no_log},
        Row{"AResultOfControlBeyondItsTicks", {.refused = 3}, rule(result, "ticks: 2"), false, false, no_log},
        Row{"AnEarlyCommandBesideALateResult",
            {.later = 2, .refused = 3},
            "[{channel: " + result + ", ticks: 3}, {channel: \"" + u + "\", atol: 1.0e-6, lead: 0.003}]",
            true,
            false,
            no_log},
        Row{"NoRotation", {.scaled = 2.0}, "[]", false, false, no_log}),
    test::by_name);

class OneJudgeText : public OneJudge {};

/// A command that steps two ticks later, where the golden was recorded by a process with other arithmetic.
TEST_F(OneJudgeText, ChecksTheLevelsOfAScenarioAlike) {
  const std::string rules = rule("*", "atol: 1.0e-3, lead: 0.003, lag: 0.003");
  record_run(scenario(rules), "golden.mcap");
  const auto done = testing::mutilate(path("golden.mcap"), testing::untouched, {}, {{"libc", "another"}});
  ASSERT_TRUE(done) << to_string(done.errors());
  std::string later = scenario(rules);
  later.replace(later.find("step 0.1 20"), 11, "step 0.1 22");
  const auto check = [&](bool controller, bool closed) {
    CheckOptions options;
    options.controller = controller;
    options.closed = closed;
    options.plant = false;
    return *check_scenario(load(later), path("golden.mcap"), path("actual.mcap"), options, {record, run_plant});
  };
  const CheckReport alone = check(true, false), together = check(false, true);
  EXPECT_EQ(alone.controller, LevelState::within) << alone.verdict.text();
  EXPECT_EQ(together.closed, LevelState::within) << together.verdict.text();
  EXPECT_EQ(alone.verdict.text(),
            "the controller repeats 60 recorded ticks within tolerance, with different arithmetic");
  later.replace(later.find("step 0.1 22"), 11, "step 0.1 24");
  const CheckReport beyond = check(true, false);
  EXPECT_EQ(beyond.controller, LevelState::differs);
  EXPECT_THAT(beyond.verdict.text(),
              HasSubstr("SHOULDER/u of Rig/C is beyond ±0.001 N·m of the golden's values "
                        "within lead and lag from tick 23 (0.023 s) on, worst 0.1 N·m (100 times) at tick 23"));
}

/// A part of a recording is judged by what follows it there.
TEST_F(OneJudgeText, LooksAheadBeyondTheEndOfAPartialReplay) {
  make({"", {.later = 2}, rule(u, "atol: 1.0e-6, lead: 0.003")});
  ReplayOptions options;
  options.until = 0.021;  // the golden steps at 0.022 s
  const ReplayReport report = controller(options);
  EXPECT_EQ(report.ticks, 21);
  EXPECT_EQ(report.values_different, 1);
  EXPECT_TRUE(report.within()) << text_of(report.beyond);
}

/// And by what precedes it.
TEST_F(OneJudgeText, LooksBackBeyondTheBeginOfAPartialComparison) {
  make({"", {.later = -2}, rule(u, "atol: 1.0e-6, lag: 0.002")});
  ReplayOptions options;
  options.from = 0.019;
  const ReplayReport report = controller(options);
  EXPECT_EQ(report.values_different, 1);
  EXPECT_TRUE(report.within()) << text_of(report.beyond);
  const LogReplayReport logged = log(rule(u, "atol: 1.0e-6, lag: 0.002"), options.from);
  EXPECT_EQ(logged.values_different, 1);
  EXPECT_TRUE(logged.within()) << text_of(logged.beyond);
}

/// control() returns false three ticks later than in the golden, also if that was recorded with other arithmetic.
TEST_F(OneJudgeText, AllowsAResultOfControlToComeLateOnAllLevels) {
  const auto resting = [](int tick, const std::string& rules) {
    return "rehearse: 1\nduration: 0.06\ncameras: none\ntolerances: " + rules +
           "\nbodies:\n  - name: Rig\n    model: rig.urdf\n    controllers: [" +
           behaviour("C", "rest " + std::to_string(tick) + " 40") + "]\n";
  };
  for (const mcap::StringMap& provenance : {mcap::StringMap(), mcap::StringMap{{"libc", "another"}}}) {
    record_run(resting(20, "[]"), "golden.mcap");
    const auto done = testing::mutilate(path("golden.mcap"), testing::untouched, {}, provenance);
    ASSERT_TRUE(done) << to_string(done.errors());
    for (const int allowed : {0, 2, 3}) {
      const std::string rules = allowed == 0 ? "[]" : rule(result, "ticks: " + std::to_string(allowed));
      CheckOptions options;
      options.plant = false;
      const auto report = check_scenario(load(resting(23, rules)), path("golden.mcap"), path("actual.mcap"), options,
                                         {record, run_plant});
      ASSERT_TRUE(report) << to_string(report.errors());
      const LevelState expected = allowed == 3 ? LevelState::within : LevelState::differs;
      EXPECT_EQ(report->controller, expected) << report->verdict.text();
      EXPECT_EQ(report->closed, expected) << report->verdict.text();
      EXPECT_EQ(report->replay->ticks_different, 3);
      if (allowed != 3) {
        EXPECT_THAT(report->verdict.text(), HasSubstr("fed with the golden's inputs, it differs at tick 20"));
      }
      if (allowed == 0) continue;
      const auto of_events = std::ranges::find(report->comparison->channels, true, &ChannelComparison::of_events);
      ASSERT_NE(of_events, report->comparison->channels.end());
      EXPECT_EQ(text_of(report->replay->first), text_of(of_events->first_bit));
    }
  }
}

TEST_F(OneJudgeText, JudgesTheSameInALongRunAsInAShortOne) {
  std::string text = scenario(rule(u, "atol: 1.0e-6, lead: 0.003, lag: 0.003"));
  text.replace(text.find("0.06"), 4, "3.00");
  record_run(text);
  std::filesystem::copy_file(path("run.mcap"), path("golden.mcap"), std::filesystem::copy_options::overwrite_existing);
  int messages = 0;  // each hundredth command is another one for a tick
  const auto done = testing::mutilate(path("golden.mcap"), [&](const mcap::Message& message) {
    const bool is_other = message.channel->topic == joints && ++messages % 100 == 0;
    return std::optional(changed({.effort = is_other ? 1.0 : 0.0}, message));
  });
  ASSERT_TRUE(done) << to_string(done.errors());
  rules_ = load(text).tolerances;
  const ReplayReport report = controller();
  EXPECT_EQ(report.values_different, 30);
  EXPECT_EQ(report.ticks_different, 30);
  EXPECT_TRUE(report.within()) << text_of(report.beyond) << " the numbers beside it are equal";
  EXPECT_TRUE(closed().within);
}

TEST_F(OneJudgeText, StatesTheDistanceThatIsJudged) {
  make({"", {.later = 2, .effort = 1e-3}, rule(u, "atol: 1.0e-6, lead: 0.003, lag: 0.003")});
  const ReplayReport early = controller();
  ASSERT_TRUE(early.beyond);
  EXPECT_THAT(text_of(early.beyond),
              HasSubstr("off by 0.001 N·m"));  // at tick 0
  make({"", {.later = 2}, rule(u, "atol: 1.0e-6, lead: 0.003, lag: 0.003")});
  const Comparison together = closed();
  ASSERT_TRUE(together.first_bit);
  EXPECT_THAT(text_of(together.first_bit),
              AllOf(HasSubstr("u is 0.1 N·m, expected 0 N·m: off by 0.1 N·m"), Not(HasSubstr("off by 0 N·m")),
                    HasSubstr("0 N·m from the golden's values within lead and lag")));
  EXPECT_EQ(text_of(controller().first), text_of(together.first_bit));
}

}  // namespace
}  // namespace rehearse
