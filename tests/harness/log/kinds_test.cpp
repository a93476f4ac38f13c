// The verdict on logs with each kind of trouble that logs of robots have, for controllers without a memory, with a
// filtered derivative and with an integral. An unchanged controller is never accused; a changed one is found where
// anything is certain.
#include "kinds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <sstream>
#include <vector>

namespace rehearse {
namespace {

using namespace kinds;
using ::testing::HasSubstr;
using ::testing::Not;

/// The exit code of `rehearse replay`.
char verdict_of(const Result<LogReplayReport>& report) {
  if (!report) return '2';
  char worst = report->undecided() ? '4' : report->within() ? '0' : '1';
  for (const LogReplayReport& part : report->after_restarts)
    if (const char verdict = part.undecided() ? '4' : part.within() ? '0' : '1'; worst == '0' || verdict == '1')
      worst = verdict;
  return worst;
}

std::string details_of(const Result<LogReplayReport>& report) {
  if (!report) return to_string(report.errors());
  std::string text = std::to_string(report->ticks_different) + " of " + std::to_string(report->ticks_compared) +
                     " differ, " + std::to_string(report->ticks) + " ticks";
  if (report->certain)
    text += ", memory " + std::to_string(report->certain->memory.value_or(-1)) + ", certain " +
            std::to_string(report->certain->different) + " of " + std::to_string(report->certain->compared);
  if (report->certain && report->certain->beyond) text += ", " + to_string(*report->certain->beyond);
  if (report->beyond) text += "; beyond: " + to_string(*report->beyond);
  if (report->timing)
    text += "; timing " + (report->timing->shift ? std::to_string(*report->timing->shift) : "of a neighbour");
  if (report->cause)
    text += "; cause " + report->cause->lines[0] + ", " + std::to_string(report->cause->different) + " of " +
            std::to_string(report->cause->ticks);
  return text + "\n" + to_string(report->remarks);
}

constexpr std::array controllers{"ServoWith_none", "ServoWith_filtered", "ServoWith_integral"};

class KindsOfLogs : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { setenv("REHEARSE_CONTROLLER_PATH", TEST_CONTROLLERS, 1); }

  Result<LogReplayReport> replay(const Kind& kind, const std::string& controller, Change change) const {
    Chance chance(17);
    Plan plan(chance);
    if (kind.plan) kind.plan(plan);
    Log log = run(plan, controller, change);
    if (kind.spoil) kind.spoil(log);
    return replay_by(write(log, folder_.path()), controller, kind.map);
  }

  Result<LogReplayReport> replay_by(const fs::path& log, const std::string& controller, const std::string& map) const {
    std::ofstream(folder_ / "map.yaml") << "rehearse_map: 1\ntime_step: 0.002\n" << map;
    LogReplayOptions options;
    options.controller = controller;
    options.model = fs::path(FIXTURES_DIR) / "models/pan_tilt_head.urdf";
    options.map = folder_ / "map.yaml";
    return replay_log(log, folder_ / "run.mcap", options);
  }

  const fs::path& folder() const { return folder_.path(); }
  /// The last log.
  fs::path log() const { return fs::exists(folder_ / "log.mcap") ? folder_ / "log.mcap" : folder_ / "log"; }

 private:
  const test::TemporaryFolder folder_;
};

class Kinds : public KindsOfLogs, public ::testing::WithParamInterface<Kind> {
 protected:
  char verdict_by_advice(const LogReplayReport& report, const std::string& controller) const;
};

/// The map with those lines instead of its own of the same keys.
std::string with_lines(const std::string& map, const std::vector<std::string>& lines) {
  const auto key_of = [](const std::string& line) { return line.substr(0, line.find(':')); };
  std::istringstream old(map);
  std::string changed;
  for (std::string line; std::getline(old, line);)
    if (std::ranges::none_of(lines, [&](const std::string& other) { return key_of(other) == key_of(line); }))
      changed += line + "\n";
  for (const std::string& line : lines) changed += line + "\n";
  return changed;
}

/// The exit code with the lines that the report proposes.
char Kinds::verdict_by_advice(const LogReplayReport& report, const std::string& controller) const {
  const auto followed = replay_by(log(), controller, with_lines(GetParam().map, report.cause->lines));
  const char verdict = verdict_of(followed);
  if (verdict != '0')
    std::cerr << controller << " with " << report.cause->lines[0] << ": " << details_of(followed) << "\n";
  return verdict;
}

TEST_P(Kinds, DoNotAccuseAnUnchangedController) {
  std::string found, details;
  for (const char* controller : controllers) {
    const auto report = replay(GetParam(), controller, Change::none);
    found += verdict_of(report);
    details += std::string(controller) + ": " + details_of(report) + "\n";
    if (!report || !report->cause) continue;
    EXPECT_EQ(verdict_by_advice(*report, controller), '0');
    if (controller != controllers.back()) continue;
    EXPECT_EQ(report->cause->lines[0], GetParam().cause) << details_of(report);
  }
  EXPECT_EQ(found, GetParam().same) << details;
}

/// Every night each change of each kind; by day one of each, in turn.
std::vector<Change> tested_changes(const std::string& kind) {
  constexpr std::array changes{Change::gain, Change::sign, Change::swapped, Change::late};
  if (AT_NIGHT) return {changes.begin(), changes.end()};
  const auto place = std::ranges::find(all(), kind, &Kind::name) - all().begin();
  return {changes[static_cast<std::size_t>(place) % changes.size()]};
}

TEST_P(Kinds, ShowAChangedController) {
  for (const Change change : tested_changes(GetParam().name)) {
    std::string found, details;
    for (const char* controller : controllers) {
      const auto report = replay(GetParam(), controller, change);
      found += verdict_of(report);
      details += std::string(controller) + ": " + details_of(report) + "\n";
      // no advice leads nowhere
      if (report && report->cause) {
        EXPECT_NE(verdict_by_advice(*report, controller), '4') << name_of(change);
      }
      if (verdict_of(report) != '1') continue;
      // by a shift of the commands, or by a tick that is certain
      if (report->timing && report->timing->shift) continue;
      ASSERT_TRUE(report->certain && report->certain->beyond) << details;
      const bool is_mid_run = std::string_view(GetParam().map).find("begins: controller") == std::string_view::npos;
      if (report->certain->is_no_state || is_mid_run) continue;
      const std::int64_t wait = report->certain->memory.value_or(0) + 12;
      EXPECT_LE(report->certain->beyond->tick, report->beyond->tick + wait) << name_of(change) << " of " << details;
    }
    EXPECT_EQ(found, GetParam().expected(change)) << name_of(change) << "\n" << details;
  }
}

/// Of the logs whose unchanged controller agrees (0), the share that shows a change (1), by the tables that the tests
/// above verify.
TEST(PowerOfKinds, FindsEachSignAndEachExchangeAndNearlyEachGain) {
  for (const auto& [change, least] :
       {std::pair(Change::sign, 1.0), std::pair(Change::swapped, 1.0), std::pair(Change::gain, 0.95)}) {
    double logs = 0.0, found = 0.0;
    std::string missed;
    for (const Kind& kind : all())
      for (std::size_t i = 0; i < controllers.size(); ++i) {
        if (kind.same[i] != '0') continue;
        ++logs;
        if (kind.expected(change)[i] == '1') {
          ++found;
        } else {
          missed += std::string(" ") + kind.name;
        }
      }
    EXPECT_GE(found, least * logs) << name_of(change) << " isn't found in" << missed;
  }
}

/// A controller that takes back a part of its state continues with another state than the robot's.
TEST_F(KindsOfLogs, DoNotAccuseAControllerThatTakesAPartOfItsStateBack) {
  const auto kind = std::ranges::find(all(), std::string_view("begins_in_mid_run_with_state"), &Kind::name);
  ASSERT_NE(kind, all().end());
  Chance chance(17);
  Plan plan(chance);
  kind->plan(plan);
  Log log = run(plan, "ServoWith_integral", Change::none);
  kind->spoil(log);
  const fs::path file = write(log, folder());
  const auto whole = replay_by(file, "ServoWith_integral", kind->map);
  EXPECT_EQ(verdict_of(whole), '0') << details_of(whole);
  EXPECT_THAT(to_string(whole->remarks), Not(HasSubstr("keeps more state")));
  const auto part = replay_by(file, "ServoWithPartOfState", kind->map);
  EXPECT_EQ(verdict_of(part), '4') << details_of(part);
  EXPECT_THAT(to_string(part->remarks), HasSubstr("the controller keeps more state than it takes"));
}

/// After a gap an integral is off for ever: the report has the beginning, the size, and that it stays so.
TEST_F(KindsOfLogs, StateHowFarAnIntegralIsOffAfterAGap) {
  const auto gap =
      std::ranges::find_if(all(), [](const Kind& kind) { return kind.name == std::string("a_burst_lost"); });
  const auto report = replay(*gap, "ServoWith_integral", Change::none);
  ASSERT_TRUE(report && report->undecided()) << details_of(report);
  ASSERT_TRUE(report->certain && report->certain->rest);
  const LogRest& rest = *report->certain->rest;
  EXPECT_EQ(rest.series.substr(rest.series.size() - 2), "/u");
  EXPECT_NEAR(rest.from, 1.28, 0.01);
  EXPECT_TRUE(rest.is_constant()) << rest.low << " to " << rest.high;
  EXPECT_GT(rest.share(), 1e-4);
  EXPECT_LT(rest.share(), 0.02);
}

/// Under a sanitizer, where they take eight minutes, each sixth kind: the kinds differ in numbers, not in code.
std::vector<Kind> tested() {
#ifdef __SANITIZE_ADDRESS__
  constexpr std::size_t one_in = 6;
#else
  constexpr std::size_t one_in = 1;
#endif
  std::vector<Kind> some;
  for (std::size_t i = 0; i < all().size(); i += one_in) some.push_back(all()[i]);
  return some;
}

INSTANTIATE_TEST_SUITE_P(All, Kinds, ::testing::ValuesIn(tested()),
                         [](const auto& parameter) { return std::string(parameter.param.name); });

}  // namespace
}  // namespace rehearse
