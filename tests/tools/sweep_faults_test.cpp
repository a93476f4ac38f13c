// rehearse sweep: the matrix of faults by expectations.
#include "sweep_fixture.h"

#include <string>
#include <vector>

namespace rehearse::test {
namespace {

/// A pendulum that falls from 1 rad below 0.5 rad in 0.26 s, unless its joint is locked before.
constexpr const char* falling = R"(rehearse: 1
duration: 0.6
bodies:
  - name: Pendulum
    model: MODEL
    joints: {HINGE: 1}
    faults:
      - {actuator: HINGE, fault: dead, effort: 0.5, from: 0}
vary:
  fault: {path: "bodies.Pendulum.faults[0].fault", grid: [dead, locked]}
  when: {path: "bodies.Pendulum.faults[0].from", grid: [0, 0.05, 0.5]}
  left: {path: "bodies.Pendulum.faults[0].effort", grid: [0.2, 0.4]}
)";

std::string with_model(std::string text, const std::string& model) {
  return text.replace(text.find("MODEL"), 5, model);
}

TEST_F(Sweep, ReportsWhichFaultsAnExpectationSurvives) {
  const std::string model = std::string(FIXTURES_DIR) + "/models/inverted_pendulum.urdf";
  write("faults.yaml", with_model(falling, model) +
                           "expect:\n  - {channel: Pendulum/HINGE/q, above: 0.5}\n"
                           "  - {channel: Pendulum/HINGE/q, below: 1.5}\n");
  const Outcome outcome = rehearse({"sweep", "faults.yaml", "-o", "run"});
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_THAT(outcome.out,
              HasSubstr("actuator Pendulum/HINGE dead    6      violated in 6 of 6: from 0 to 0.5  holds in 6\n"));
  EXPECT_THAT(outcome.out,
              HasSubstr("actuator Pendulum/HINGE locked  6      violated in 2 of 6: from 0.5       holds in 6\n"));
  EXPECT_THAT(outcome.out, HasSubstr("(1) Pendulum/HINGE/q above 0.5 rad\n(2) Pendulum/HINGE/q below 1.5 rad\n"));
  EXPECT_THAT(read_file(folder() / "run/report.md"),
              HasSubstr("| actuator Pendulum/HINGE locked | 6 | violated in 2 of 6: from 0.5 | holds in 6 |\n"));
  EXPECT_THAT(read_file(folder() / "run/report.html"), HasSubstr("<td>violated in 2 of 6: from 0.5</td>"));
  const auto faults = rehearse({"sweep", "report", "run", "--json"}).json()["faults"];
  ASSERT_EQ(faults.size(), 2u);
  const auto& locked = faults[1];
  EXPECT_EQ(locked["fault"], "actuator Pendulum/HINGE locked");
  EXPECT_EQ(locked["cases"], 6);
  EXPECT_EQ(locked["expectations"][0]["survives"], false);
  EXPECT_EQ(locked["expectations"][0]["violated"], 2);
  EXPECT_LT(locked["expectations"][0]["least_margin"], 0.0);
  EXPECT_EQ(locked["expectations"][1]["survives"], true);
  EXPECT_EQ(locked["expectations"][1]["expectation"], "Pendulum/HINGE/q below 1.5 rad");
}

TEST_F(Sweep, HasNoMatrixWithoutAFaultThatVaries) {
  box();
  const Outcome outcome = rehearse({"sweep", "box.yaml", "--cases", "5", "-o", "run"});
  EXPECT_THAT(outcome.out, Not(HasSubstr("(1)")));
  EXPECT_THAT(read_file(folder() / "run/report.md"), Not(HasSubstr("Faults and expectations")));
  EXPECT_EQ(rehearse({"sweep", "report", "run", "--json"}).json()["faults"].size(), 0u);
}

}  // namespace
}  // namespace rehearse::test
