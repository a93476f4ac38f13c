// The span of an expectation, for the series of all kinds of devices: it begins with the first sample, whether the
// expectation is a `channel` or an expression, and whether the expression reads other ticks.
#include <fmt/format.h>
#include <rehearse/check.h>

#include <cmath>

#include "core/scenario/declared_source.h"
#include "runs.h"

namespace rehearse {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class ExpectationSpans : public RunTest {
 protected:
  /// The rig with a sensor of each kind; the first controller reads all of them and the joints' displacements, the
  /// second one commands a displacement of one joint and an effort of the other.
  ExpectationSpans() {
    std::string model = rig_urdf;
    const auto laser = [](const std::string& name, const std::string& rate) {
      return "<sensor name=\"" + name + "\" type=\"ray\"><update_rate>" + rate +
             "</update_rate><ray><scan><horizontal><samples>3</samples><min_angle>-0.5</min_angle>"
             "<max_angle>0.5</max_angle></horizontal></scan><range><min>0.1</min><max>30</max></range></ray></sensor>";
    };
    model.insert(model.find("<sensor name=\"Force\""),
                 R"(<sensor name="Compass" type="magnetometer"/><sensor name="Touch" type="contact"/>)" +
                     laser("Laser", "200") + laser("Late", "10"));
    write("rig.urdf", model);
    run_ = record_run(rig(behaviour("Reads", "sense") + ", " + behaviour("Mixed", "mixed"), ""));
  }

  static Expectation always(const std::string& condition) {
    Expectation expectation;
    expectation.subject = Expectation::Subject::expression;
    expectation.expression = condition;
    EXPECT_TRUE(declare_expressions(Scenario(), expectation).empty()) << condition;
    return expectation;
  }
  static Expectation bounded(const std::string& series) {
    Expectation expectation;
    expectation.pattern = series;
    expectation.above = -1e12;
    expectation.below = 1e12;
    return expectation;
  }
  ExpectationResult judged(const Expectation& expectation) const { return judge_expectations({expectation}, run_)[0]; }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& [name, place] : run_.series())
      if (name.starts_with("Rig/")) all.push_back(name);
    return all;
  }
  static std::string state(const ExpectationResult& result) {
    return result.holds ? "holds" : result.undecided ? "undecided" : "violated";
  }

  Trace run_;
};

TEST_F(ExpectationSpans, BeginWithTheFirstSampleOfEachSeriesInBothKinds) {
  for (const char* device : {"Accelerometer", "Gyro", "Imu", "Force", "Compass", "Touch", "Camera"})
    EXPECT_THAT(names(), Contains(StartsWith(fmt::format("Rig/{}/", device))));
  EXPECT_THAT(names(), Contains("Rig/Laser/ranges/0"));
  for (const std::string& name : names()) {
    const ExpectationResult bounds = judged(bounded(name));
    const ExpectationResult expression = judged(always(fmt::format("'{}' > -1e12 && '{}' < 1e12", name, name)));
    EXPECT_EQ(state(bounds), state(expression)) << name << ": " << bounds.sentence << "; " << expression.sentence;
    const bool may_be_infinite = name.find("ranges") != std::string::npos || name.find("depth") != std::string::npos;
    if (!may_be_infinite && bounds.not_judged.empty()) {
      EXPECT_TRUE(bounds.holds) << bounds.sentence;
    }
  }
}

TEST_F(ExpectationSpans, BeginWithTheFirstSampleForEachOperatorWithMemory) {
  for (const char* series :
       {"Rig/Accelerometer/linear_acceleration/x", "Rig/Gyro/angular_velocity/y", "Rig/Force/force/z",
        "Rig/Compass/magnetic_field/x", "Rig/Touch/force/z", "Rig/SHOULDER/q"}) {
    ASSERT_TRUE(run_.find_series(series)) << series;
    for (const char* condition :
         {"abs('{0}') < 1e12", "abs(delta('{0}')) < 1e12", "abs(prev('{0}')) < 1e12", "!nan('{0}')",
          "!step('{0}', 1e12)", "changed('{0}') || !changed('{0}')", "abs('{0}' - at('{0}', 0.004 s)) < 1e12",
          "prev(abs('{0}') < 1e12)", "prev(prev('{0}')) < 1e12"}) {
      const ExpectationResult result = judged(always(fmt::format(fmt::runtime(condition), series)));
      EXPECT_TRUE(result.holds) << result.sentence;
    }
    Expectation lasting = always(fmt::format("abs('{}') < 1e12 for 0.002 s", series));
    lasting.until = 0.017;
    EXPECT_TRUE(judged(lasting).holds) << judged(lasting).sentence;
    Expectation triggered = always(fmt::format("abs(delta('{}')) < 1e12", series));
    triggered.after = fmt::format("abs('{}') < 1e12", series);
    EXPECT_TRUE(judged(triggered).holds) << judged(triggered).sentence;
    EXPECT_EQ(state(judged(always(fmt::format("abs('{}') < -1", series)))), "violated") << series;
  }
}

TEST_F(ExpectationSpans, JudgeNoQuantityOfAJointThatNobodyEnabled) {
  Expectation efforts = bounded("Rig/*/u");
  const ExpectationResult result = judged(efforts);
  EXPECT_TRUE(result.holds) << result.sentence;
  EXPECT_THAT(result.not_judged, ::testing::ElementsAre("Rig/Mixed/output/RAIL/u"));
  EXPECT_THAT(verdict({result}), HasSubstr("; not judged: Rig/Mixed/output/RAIL/u has no sample"));
  const ExpectationResult alone = judged(always("abs(Rig/Mixed/output/RAIL/u) < 5"));
  EXPECT_TRUE(alone.undecided);
  EXPECT_EQ(alone.sentence,
            "undecided: always abs(Rig/Mixed/output/RAIL/u) < 5: not judged, Rig/Mixed/output/RAIL/u has no sample");
}

TEST_F(ExpectationSpans, JudgeNoSensorWhoseFirstSampleComesAfterTheRun) {
  ASSERT_FALSE(run_.find_series("Rig/Late/ranges/0")) << "its period is longer than the run";
  for (const Expectation& expectation :
       {bounded("Rig/Late/ranges/0"), bounded("Rig/Late/ranges/*"), always("Rig/Late/ranges/0 < 100")}) {
    const ExpectationResult result = judged(expectation);
    EXPECT_TRUE(result.undecided) << result.sentence;
    EXPECT_THAT(result.sentence, HasSubstr("has no sample"));
    EXPECT_FALSE(result.problem);
  }
  EXPECT_EQ(state(judged(bounded("Rig/Lite/*"))), "violated") << "a pattern that matches nothing";
}

}  // namespace
}  // namespace rehearse
