// The truth lies in the intervals of fits to simulated robots whose numbers are hidden.
#include <rehearse/fit.h>

#include <cmath>
#include <cstdlib>
#include <map>

#include "base/chance.h"
#include "hidden_robot.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;

struct Truth {
  FitRequest request;
  double value;
};

class Fit : public test::HiddenRobot {
 protected:
  /// The count of the truths that lie in their intervals; each must be identified.
  int held(const FitResult& result, const std::vector<Truth>& truths) const {
    int count = 0;
    for (std::size_t i = 0; i < truths.size(); ++i) {
      const FittedNumber& number = result.numbers[i];
      EXPECT_TRUE(number.is_identified()) << number.path << ": " << number.reason;
      const bool holds = number.low <= truths[i].value && truths[i].value <= number.high;
      if (std::getenv("FIT_TABLE"))
        fmt::print("{} {}: truth {} in {} to {} ({})\n", holds ? "held" : "MISSED", number.path, truths[i].value,
                   number.low, number.high, number.value);
      count += holds ? 1 : 0;
    }
    return count;
  }
  static std::vector<FitRequest> requests(const std::vector<Truth>& truths) {
    std::vector<FitRequest> all;
    for (const Truth& truth : truths) all.push_back(truth.request);
    return all;
  }
};

/// Rules of the actuators of all joints, and of the last link's mass.
std::string rules(double damping, double coulomb, double delay, const std::string& link, double mass) {
  return fmt::format(
      "    actuators: [{{joint: \"*\", damping: {}, coulomb: {}, delay: {}}}]\n    links: {{{}: {{mass: {}}}}}\n",
      damping, coulomb, delay, link, mass);
}

TEST_F(Fit, FindsTheNumbersOfAPendulumFromNoisyJoints) {
  const std::string flight = fly("flight", scenario("pendulum", rules(0.3, 0.2, 0.0034, "ARM", 1.2)) + noise);
  const std::vector<Truth> truths{{{"bodies.Robot.actuators[0].damping", {}, {}}, 0.3},
                                  {{"bodies.Robot.actuators[0].coulomb", {}, {}}, 0.2},
                                  {{"bodies.Robot.actuators[0].delay", 0.0, 0.02}, 0.0034},
                                  {{"bodies.Robot.links.ARM.mass", {}, {}}, 1.2}};
  const auto result = fit_to({flight}, scenario("pendulum", rules(0.1, 0.05, 0.0, "ARM", 1.0)), requests(truths));
  ASSERT_TRUE(result) << to_string(result.errors());
  held(*result, truths);
  for (std::size_t i = 0; i < truths.size(); ++i) {
    const FittedNumber& number = result->numbers[i];
    // 3.1 standard deviations: one of 500 such numbers is farther off
    EXPECT_LT(std::abs(number.value - truths[i].value), 1.6 * 0.5 * (number.high - number.low)) << number.path;
    EXPECT_LT(number.high - number.low, 0.3 * truths[i].value) << number.path;
  }
  EXPECT_GT(result->before, 3.0);
  EXPECT_NEAR(result->after, 1.0, 0.05);
  EXPECT_FALSE(result->has_complete_states);
  EXPECT_THAT(result->text, HasSubstr("rehearse: 1"));
}

TEST_F(Fit, HasTheSameBitsWithAnyNumberOfProcesses) {
  const std::string flight = fly("flight", scenario("arm", rules(0.2, 0.1, 0.0, "LOWER", 0.8), "1", 1.0) + noise);
  const std::string paper = scenario("arm", rules(0.1, 0.05, 0.0, "LOWER", 0.7), "1", 1.0);
  const std::vector<FitRequest> vary{{"bodies.Robot.actuators[0].damping", {}, {}},
                                     {"bodies.Robot.links.LOWER.mass", {}, {}}};
  const auto first = fit_to({flight}, paper, vary, 1);
  ASSERT_TRUE(first) << to_string(first.errors());
  for (const std::size_t jobs : {1u, 3u}) {
    const auto again = fit_to({flight}, paper, vary, jobs);
    ASSERT_TRUE(again);
    for (std::size_t i = 0; i < vary.size(); ++i) {
      EXPECT_EQ(again->numbers[i].value, first->numbers[i].value) << jobs;
      EXPECT_EQ(again->numbers[i].low, first->numbers[i].low) << jobs;
      EXPECT_EQ(again->numbers[i].high, first->numbers[i].high) << jobs;
    }
    EXPECT_EQ(again->text, first->text);
    EXPECT_EQ(again->evaluations, first->evaluations);
  }
}

/// The probability of at most `count` of `all` with that share.
double at_most(int count, int all, double share) {
  double sum = 0.0;
  for (int k = 0; k <= count; ++k)
    sum += std::exp(std::lgamma(all + 1.0) - std::lgamma(k + 1.0) - std::lgamma(all - k + 1.0) + k * std::log(share) +
                    (all - k) * std::log1p(-share));
  return sum;
}

/// Pendulums and arms of two, each with numbers of its own. 6 by day, 30 at night.
TEST_F(Fit, HoldsTheTruthInItsIntervals) {
  const int robots = AT_NIGHT ? 30 : 6;
  int count = 0, all = 0;
  for (int robot = 0; robot < robots; ++robot) {
    const Chance chance(86, robot);
    const bool is_arm = robot % 2 == 1;
    const std::string link = is_arm ? "LOWER" : "ARM";
    const double damping = 0.1 + 0.3 * chance.uniform(0), coulomb = 0.1 + 0.2 * chance.uniform(1),
                 mass = 0.6 + 0.8 * chance.uniform(2);
    const std::string model = is_arm ? "arm" : "pendulum";
    const std::string flight =
        fly("flight", scenario(model, rules(damping, coulomb, 0.0, link, mass), "1", 2.0, robot + 1) + noise);
    const std::vector<Truth> truths{{{"bodies.Robot.actuators[0].damping", {}, {}}, damping},
                                    {{"bodies.Robot.actuators[0].coulomb", {}, {}}, coulomb},
                                    {{"bodies.Robot.links." + link + ".mass", {}, {}}, mass}};
    const auto result = fit_to({flight}, scenario(model, rules(0.2, 0.15, 0.0, link, 1.0), "1", 2.0), requests(truths));
    ASSERT_TRUE(result) << to_string(result.errors());
    count += held(*result, truths);
    all += static_cast<int>(truths.size());
  }
  EXPECT_GT(at_most(count, all, 0.95), 0.001) << count << " of " << all;
}

TEST_F(Fit, TakesCompleteStatesOfARobotWithAFreeBase) {
  const auto floating = [&](double damping) {
    return "rehearse: 1\nduration: 1\ngravity: [0, 0, 0]\nbodies:\n  - name: Robot\n    model: arm.urdf\n"
           "    controllers: [{name: Shake, library: Shaker, options: \"1\"}]\n" +
           fmt::format("    actuators: [{{joint: \"*\", damping: {}, delay: 0}}]\n", damping);
  };
  const FitRequest damping{"bodies.Robot.actuators[0].damping", {}, {}};
  const auto result = fit_to({fly("complete", floating(0.2), 0.1)}, floating(0.1), {damping});
  ASSERT_TRUE(result) << to_string(result.errors());
  EXPECT_TRUE(result->has_complete_states);
  EXPECT_NEAR(result->numbers[0].value, 0.2, 1e-4);
  EXPECT_LT(result->after, 0.1 * result->before);

  const auto without = fit_to({fly("without", floating(0.2))}, floating(0.1), {damping});
  ASSERT_FALSE(without);
  EXPECT_THAT(without.errors().front().message,
              HasSubstr("the state of the world isn't known: the base of 'Robot' isn't fixed, and the recording has "
                        "no checkpoints"));
  const auto late = fit_to({path("complete.mcap")}, floating(0.1), {{"bodies.Robot.actuators[0].delay", 0.0, 0.01}});
  ASSERT_FALSE(late);
  EXPECT_THAT(late.errors().front().message, HasSubstr("delays differ from those of the recording"));
}

TEST_F(Fit, JudgesAnotherRecordingAndFindsWear) {
  const auto robot = [&](double coulomb, int seed) {
    return scenario("pendulum", rules(0.3, coulomb, 0.0, "ARM", 1.0), "1", 2.0, seed) + noise;
  };
  const std::string monday = fly("monday", robot(0.2, 1)), tuesday = fly("tuesday", robot(0.2, 2)),
                    friday = fly("friday", robot(0.3, 3));
  const std::string paper = scenario("pendulum", rules(0.1, 0.1, 0.0, "ARM", 1.0), "1", 2.0);
  const std::vector<FitRequest> vary{{"bodies.Robot.actuators[0].damping", {}, {}},
                                     {"bodies.Robot.actuators[0].coulomb", {}, {}}};
  const auto first = fit_to({monday}, paper, vary), second = fit_to({tuesday}, paper, vary),
             third = fit_to({friday}, paper, vary);
  ASSERT_TRUE(first && second && third);
  FitOptions options;
  options.vary = vary;
  const auto judged = judge_fit(folder_ / "paper.yaml", *first, tuesday, options);
  ASSERT_TRUE(judged) << to_string(judged.errors());
  EXPECT_NEAR(judged->after, 1.0, 0.05);
  EXPECT_GT(judged->before, 1.5);

  for (const WornNumber& number : wear(*first, *second)) EXPECT_FALSE(number.has_moved) << number.earlier.path;
  const std::vector<WornNumber> worn = wear(*first, *third);
  EXPECT_FALSE(worn[0].has_moved);
  EXPECT_TRUE(worn[1].has_moved);
  EXPECT_LT(worn[1].probability, 1e-6);
}

TEST_F(Fit, TakesIntervalsFromDrawnStretches) {
  const std::string flight = fly("flight", scenario("pendulum", rules(0.3, 0.2, 0.0, "ARM", 1.0), "1", 2.0) + noise);
  folder_.write("paper.yaml", scenario("pendulum", rules(0.1, 0.2, 0.0, "ARM", 1.0), "1", 2.0));
  FitOptions options;
  options.vary = {{"bodies.Robot.actuators[0].damping", {}, {}}};
  const auto curved = fit(folder_ / "paper.yaml", {flight}, options);
  options.bootstrap = 400;
  const auto drawn = fit(folder_ / "paper.yaml", {flight}, options);
  ASSERT_TRUE(curved && drawn);
  EXPECT_EQ(curved->numbers[0].value, drawn->numbers[0].value);
  const double ratio =
      (drawn->numbers[0].high - drawn->numbers[0].low) / (curved->numbers[0].high - curved->numbers[0].low);
  EXPECT_GT(ratio, 0.6);
  EXPECT_LT(ratio, 1.6);
  EXPECT_NE(ratio, 1.0);
}

}  // namespace
}  // namespace rehearse
