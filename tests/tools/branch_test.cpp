// What if: rehearse replay --set, and rehearse record --from-checkpoint.
#include "command.h"

#include <gmock/gmock.h>

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class Branch : public Command {
 protected:
  void record_sr1() const { done({"record", sr1_without_cameras().string(), "-o", "sr1.mcap"}); }

  void expect_refused(const std::vector<std::string>& arguments, const std::string& message) const {
    const Outcome outcome = rehearse(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.out << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(message));
    EXPECT_EQ(outcome.out, "");
  }
};

TEST_F(Branch, ShowsWhatTheControllerDoesOfAnAlteredInput) {
  record_sr1();
  const Outcome outcome =
      rehearse({"replay", "sr1.mcap", "--set", "SR1/RLEG_KNEE/q+=0.01@tick:40..59", "-o", "if.mcap"});
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("\nwith inputs altered: differs: RLEG_KNEE/u is beyond ±0.002 N·m from "
                                     "tick 40 (0.04 s) on, worst "));
  EXPECT_THAT(outcome.out, HasSubstr("\nworst: "));
  EXPECT_THAT(done({"replay", "if.mcap"}).out, HasSubstr("\nequal bit for bit: "));
  EXPECT_THAT(done({"info", "if.mcap"}).out, HasSubstr("SR1/RLEG_KNEE/q+=0.01@tick:40..59"));
  const auto words = rehearse({"replay", "sr1.mcap", "--json"}).json()["words"];
  EXPECT_EQ(words["different"], 0);
}

TEST_F(Branch, IsItsSourceWithoutAChange) {
  record_sr1();
  const Outcome outcome = done({"record", "--from-checkpoint", "sr1.mcap@tick:50"});
  EXPECT_THAT(outcome.out, HasSubstr("\ncontrol() of SR1/SR1Minimum: median "));
  EXPECT_THAT(outcome.out, StartsWith("branched off sr1.mcap at tick 50 (0.05 s): "));
  EXPECT_EQ(outcome.err, "") << "the recorded commands lead the world to the recorded state";
  EXPECT_THAT(outcome.out,
              HasSubstr("\nbefore it the controllers, on the recorded inputs, repeat their commands bit for bit\n"));
  EXPECT_THAT(outcome.out, HasSubstr("\n50 ticks simulated from there"));
  EXPECT_THAT(done({"diff", "sr1.mcap", "sr1.branch.mcap"}).out, StartsWith("equal bit for bit"));
  EXPECT_THAT(done({"info", "sr1.branch.mcap"}).out, HasSubstr("rehearse.branch"));
}

TEST_F(Branch, GoesItsOwnWayUnderAPush) {
  record_sr1();
  done({"record", "--from-checkpoint", "sr1.mcap@0.05s", "--push", "SR1/WAIST force=0,80,0 @0.06s..0.07s", "--duration",
        "0.03", "-o", "pushed.mcap"});
  EXPECT_THAT(rehearse({"diff", "sr1.mcap", "pushed.mcap"}).out, HasSubstr("tick 61 "));
  EXPECT_THAT(done({"replay", "pushed.mcap"}).out, HasSubstr("\nequal bit for bit: 80 ticks, "));
}

TEST_F(Branch, IsAGoldenLikeAnyOther) {
  record_sr1();
  const std::string other = "SR1Minimum=" + std::string(CHANGED_GAIN);
  rehearse({"record", "--from-checkpoint", "sr1.mcap@0.05s", "--controller", other, "-o", "other.mcap"});
  const Outcome checked = rehearse({"check", "sr1.yaml", "--golden", "other.mcap", "--controller", other});
  EXPECT_EQ(checked.status, 0) << checked.out << checked.err;
  EXPECT_THAT(checked.out, HasSubstr("controller: equal; plant: equal; closed: not compared"));
  EXPECT_THAT(checked.out, HasSubstr("until tick 50 other controllers moved its world"));

  done({"record", "--from-checkpoint", "sr1.mcap@0.05s", "--push", "SR1/WAIST force=0,80,0 @0.06s..0.07s", "-o",
        "pushed.mcap"});
  const Outcome pushed = rehearse({"check", "sr1.yaml", "--golden", "pushed.mcap"});
  EXPECT_EQ(pushed.status, 0) << pushed.out << pushed.err;
  EXPECT_THAT(pushed.out, HasSubstr("closed: equal"));
}

TEST_F(Branch, TellsWhatIsWrongWithItsWords) {
  record_sr1();
  expect_refused({"replay", "sr1.mcap", "--set", "SR1/RLEG_KNE/q=1"},
                 "error: there is no input 'SR1/RLEG_KNE/q'; similar inputs: SR1/RLEG_KNEE/q");
  expect_refused({"record", "--from-checkpoint", "sr1.mcap"}, "error: --from-checkpoint: that names no moment");
  expect_refused({"record", "--from-checkpoint", "sr1.mcap@7s"},
                 "sr1.mcap: error: its last whole tick is 99 (0.099 s)");
  expect_refused({"record", "--from-checkpoint", "sr1.mcap@tick:5", "--seed", "3"}, "--seed with --from-checkpoint");
  expect_refused({"record", "--from-checkpoint", "sr1.mcap@tick:5", "--until", "1", "--duration", "1"},
                 "a branch has one end");
  expect_refused({"record", "sr1.yaml", "--push", "SR1/WAIST force=0,0,1 @1s..2s"}, "are for branches");
  expect_refused({"record", "--from-checkpoint", "sr1.yaml@0.05s"}, "sr1.yaml: error: not an MCAP file");
}

}  // namespace
}  // namespace rehearse::test
