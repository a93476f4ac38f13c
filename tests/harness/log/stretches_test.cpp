// A log judges a controller only in the ticks that depend on nothing but inputs in the log. Each kind of trouble is
// written with the commands of the true controller, and of one with a planted change, for controllers with no memory, a
// filtered derivative and an integral.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>

#include "logs/robot_log/log_memory.h"
#include "robot_run.h"

namespace rehearse {
namespace {

using namespace robot_run;

enum class Verdict { same, differs, undecided };

std::string_view name_of(Verdict verdict) {
  return verdict == Verdict::same ? "same" : verdict == Verdict::differs ? "differs" : "undecided";
}

/// A trouble of the log.
struct Trouble {
  const char* name;
  void (*happen)(RobotRun& run);
  Verdict of_integral;  // the verdict on an unchanged controller with an integral; others agree
  Verdict of_changed_integral = Verdict::undecided;
};

void drop_states(RobotRun& run, std::size_t from, std::size_t until) {
  for (std::size_t i = from; i < until; ++i) run.states[i].is_kept = false;
}

/// The log begins in mid-run.
void cut_the_beginning(RobotRun& run) {
  drop_states(run, 0, 500);
  for (std::size_t i = 0; i < 500; ++i) run.commands[i].is_kept = false;
}

constexpr Trouble troubles[] = {
    {"nothing", [](RobotRun&) {}, Verdict::same},
    {"one_message_lost", [](RobotRun& run) { drop_states(run, 1000, 1001); }, Verdict::same},
    {"a_burst_lost", [](RobotRun& run) { drop_states(run, 600, 640); }, Verdict::undecided},
    {"half_a_second_without_inputs", [](RobotRun& run) { drop_states(run, 700, 950); }, Verdict::undecided},
    {"begins_in_mid_run", cut_the_beginning, Verdict::undecided},
};

enum class Change { none, gain, sign, late };

void plant(Change change, RobotRun& run) {
  for (std::size_t i = run.commands.size(); i-- > 0;)
    for (std::size_t j = 0; j < run.commands[i].joints.effort.size(); ++j) {
      double& effort = run.commands[i].joints.effort[j];
      if (change == Change::gain) effort *= 1.01;
      if (change == Change::sign) effort = -effort;
      if (change == Change::late && i > 0) effort = run.commands[i - 1].joints.effort[j];
    }
}

class Stretches : public RobotRunLog {
 protected:
  static void SetUpTestSuite() { setenv("REHEARSE_CONTROLLER_PATH", TEST_CONTROLLERS, 1); }

  /// The verdict of a log with that trouble; it ends by the exit code of the command.
  Verdict verdict_on(const char* controller, const Trouble& trouble, Change change, std::string& details,
                     const char* beginning = "") {
    const Robot robot(controller, "pendulum.urdf", joints_of("pendulum.urdf"), false);
    RobotRun run = robot.run(11, {0.05, 0.0}, 1500);
    plant(change, run);
    trouble.happen(run);
    write(run);
    const auto report = replay(robot, std::string(by_message) + beginning);
    if (!report) {
      ADD_FAILURE() << to_string(report.errors());
      return Verdict::undecided;
    }
    if (report->beyond) details = to_string(*report->beyond);
    if (report->certain)
      details += "; memory " + std::to_string(report->certain->memory.value_or(-1)) + ", " +
                 std::to_string(report->certain->compared) + " certain, " + std::to_string(report->certain->different) +
                 " of them differ";
    return report->undecided() ? Verdict::undecided : report->within() ? Verdict::same : Verdict::differs;
  }
};

TEST_F(Stretches, OfAnUnchangedControllerAccuseNobody) {
  for (const Trouble& trouble : troubles) {
    for (const char* controller : {"ServoWith_none", "ServoWith_filtered", "ServoWith_integral"}) {
      std::string details;
      const bool has_integral = std::string_view(controller) == "ServoWith_integral";
      const Verdict expected = has_integral ? trouble.of_integral : Verdict::same;
      EXPECT_EQ(name_of(verdict_on(controller, trouble, Change::none, details)), name_of(expected))
          << controller << ", " << trouble.name << ": " << details;
    }
  }
}

TEST_F(Stretches, OfAChangedControllerFindTheChange) {
  for (const Trouble& trouble : troubles) {
    for (const Change change : {Change::gain, Change::sign, Change::late}) {
      for (const char* controller : {"ServoWith_none", "ServoWith_filtered", "ServoWith_integral"}) {
        std::string details;
        const bool has_integral = std::string_view(controller) == "ServoWith_integral";
        const Verdict found = verdict_on(controller, trouble, change, details);
        if (has_integral)
          EXPECT_NE(name_of(found), "same") << trouble.name << ": " << details;
        else
          EXPECT_EQ(name_of(found), "differs")
              << controller << ", " << trouble.name << ", change " << static_cast<int>(change) << ": " << details;
      }
    }
  }
}

/// The map states that the log has the controller's start: then an integral is known, too.
TEST_F(Stretches, OfALogWithTheControllersStartFindAChangedIntegral) {
  std::string details;
  for (const Change change : {Change::gain, Change::sign, Change::late})
    EXPECT_EQ(name_of(verdict_on("ServoWith_integral", troubles[0], change, details, "begins: controller\n")),
              "differs")
        << details;
  EXPECT_EQ(name_of(verdict_on("ServoWith_integral", troubles[0], Change::none, details, "begins: controller\n")),
            "same");
}

/// A number that the controller takes back has to be in the log.
TEST_F(Stretches, RefuseAStateThatIsNotTheControllers) {
  const Robot robot("ServoWith_integral", "pendulum.urdf", joints_of("pendulum.urdf"), false);
  write(robot.run(11, {0.05, 0.0}, 200));
  const auto refused = [&](const std::string& state, const std::string& controller) {
    const auto report = replay(robot, std::string(by_message) + "state: " + state + "\n", controller);
    return report ? std::string("it wasn't refused") : to_string(report.errors());
  };
  const std::string joint = joints_of("pendulum.urdf")[0];
  EXPECT_THAT(refused("{topic: /efforts, names: [A]}", "ServoWith_integral"),
              ::testing::HasSubstr("takes '" + joint + "/last' back, which 'state' doesn't have"));
  EXPECT_THAT(refused("{topic: /efforts, names: [A]}", "ServoWithoutState"),
              ::testing::HasSubstr("ServoWithoutState' takes no state back"));
}

CommandRecord record_of(const std::function<double(int)>& command, int from, int until) {
  CommandRecord record;
  record.begin(std::int64_t{1'000'000} * from);
  for (int i = from; i < until; ++i)
    record.add(std::int64_t{1'000'000} * i, {{std::nullopt, command(i), 0.0, command(i)}});
  return record;
}

TEST(ControllerMemory, IsTheNumberOfTicksUntilALaterStartNoLongerShows) {
  const auto plain = [](int i) { return std::sin(0.1 * i); };
  const auto fading = [&](int i) { return plain(i) + std::exp(-0.2 * (i - 50)); };
  const auto lasting = [&](int i) { return plain(i) + 0.3; };
  const CommandRecord whole = record_of(plain, 0, 400);
  EXPECT_EQ(memory_of(whole, record_of(plain, 50, 400), 0.001), 0);
  const auto memory = memory_of(whole, record_of(fading, 50, 400), 0.001);
  ASSERT_TRUE(memory);
  EXPECT_NEAR(static_cast<double>(*memory), 100.0, 3.0);  // until exp() is 1e-9 of the range of 2
  EXPECT_FALSE(memory_of(whole, record_of(lasting, 50, 400), 0.001));
  EXPECT_FALSE(memory_of(whole, record_of(plain, 395, 400), 0.001)) << "too few ticks";
}

/// Commands, those of the log, and interruptions.
CommandRecord record_of_log(const std::function<double(int)>& command, const std::function<double(int)>& logged,
                            int from, int interrupted_each = 0) {
  CommandRecord record;
  record.begin(std::int64_t{1'000'000} * from, {{"KNEE/u", "N·m", 2.0}});
  for (int i = from; i < 1000; ++i) {
    if (interrupted_each > 0 && i % interrupted_each == 0) record.interrupt(std::int64_t{1'000'000} * i);
    record.add(std::int64_t{1'000'000} * i, {{logged(i), command(i), 0.0, command(i)}});
  }
  return record;
}

TEST(MissingState, IsToldFromAChangedSignAndFromHalfAGain) {
  const auto plain = [](int i) { return std::sin(0.1 * i); };
  const auto negative = [&](int i) { return -plain(i); };
  const auto half = [&](int i) { return 0.5 * plain(i); };
  const auto shifted = [&](int i) { return plain(i) + 5.0; };
  const auto wandering = [&](int i) { return plain(i) + 0.3 * std::sin(0.05 * i); };
  const CommandRecord later = record_of_log([&](int i) { return plain(i) + 0.3; }, plain, 250);
  EXPECT_TRUE(is_no_state(record_of_log(plain, negative, 0), later));
  EXPECT_TRUE(is_no_state(record_of_log(plain, half, 0), later));
  EXPECT_FALSE(is_no_state(record_of_log(plain, shifted, 0), later)) << "an integral";
  EXPECT_FALSE(is_no_state(record_of_log(plain, negative, 0, 150), later)) << "no stretch is long enough";
  const CommandRecord wandering_later = record_of_log(wandering, plain, 250);
  EXPECT_FALSE(is_no_state(record_of_log(plain, wandering, 0), wandering_later)) << "the state lasts, and is seen so";
}

TEST(ControllerMemory, IsMeasuredWhereTicksHaveCommands) {
  const auto plain = [](int i) { return std::sin(0.1 * i); };
  CommandRecord record = record_of(plain, 0, 30);
  EXPECT_TRUE(record.begins_steadily(0.001));
  CommandRecord after_a_gap;
  after_a_gap.begin(0);
  for (int i = 8; i < 60; ++i) after_a_gap.add(std::int64_t{1'000'000} * i, {{std::nullopt, plain(i), 0.0, plain(i)}});
  EXPECT_FALSE(after_a_gap.begins_steadily(0.001));
}

TEST(LogCertainty, BeginsAfterTheMemoryAndAfterEachInterruption) {
  LogCertainty certainty(3, false);
  std::string certain;
  for (int tick = 0; tick < 12; ++tick) certain += certainty.take(tick, tick == 6, true, true) ? '1' : '0';
  EXPECT_EQ(certain, "000111000011");
  EXPECT_TRUE(LogCertainty(3, true).take(0, false, false, true)) << "the controller starts there";
}

TEST(LogCertainty, OfAMemoryWithoutLimitNeedsAHundredTicksThatAgreeAndMove) {
  LogCertainty moves(std::nullopt, false), rests(std::nullopt, false);
  int certain = 0, at_rest = 0;
  for (int tick = 0; tick < 150; ++tick) {
    certain += moves.take(tick, false, true, true) ? 1 : 0;
    at_rest += rests.take(tick, false, true, false) ? 1 : 0;
  }
  EXPECT_EQ(certain, 50);
  EXPECT_EQ(at_rest, 0) << "constant commands agree by accident";
  EXPECT_FALSE(moves.take(150, true, true, true));
  EXPECT_FALSE(moves.take(151, false, false, true));
}

}  // namespace
}  // namespace rehearse
