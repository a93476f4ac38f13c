// rehearse record --model: a robot without a scenario; and --json.
#include <gmock/gmock.h>

#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;

class RecordModel : public Command {
 protected:
  const std::string quadruped_ = (fixtures / "models/quadruped.urdf").string();
};

TEST_F(RecordModel, StandsOnAFloorFromTheFirstTickOn) {
  done({"record", "--model", quadruped_, "--duration", "0.01", "-o", "q.mcap"});
  const std::string contacts = done({"cat", "q.mcap", "--topics", "/contacts", "--limit", "1"}).out;
  EXPECT_THAT(contacts, HasSubstr("Floor"));
}

TEST_F(RecordModel, TheSavedScenarioSaysTheSame) {
  const std::string pendulum = (fixtures / "models/pendulum.urdf").string();
  const std::vector<std::string> words = {"record", "--model", pendulum, "--controller", MISBEHAVING, "--duration", "0.02"};
  auto with = [&](std::vector<std::string> more) {
    std::vector<std::string> all = words;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  done(with({"-o", "a.mcap"}));
  done(with({"--save-scenario", "saved.yaml", "-o", "b.mcap"}));
  done({"record", "saved.yaml", "-o", "c.mcap"});
  EXPECT_EQ(rehearse({"diff", "a.mcap", "b.mcap"}).status, 0);
  EXPECT_EQ(rehearse({"diff", "b.mcap", "c.mcap"}).status, 0);
  EXPECT_THAT(rehearse(with({"--save-scenario", "saved.yaml"})).err, HasSubstr("there is a file saved.yaml already"));
}

TEST_F(RecordModel, OptionsThatDontBelongTogetherAreRefused) {
  EXPECT_THAT(rehearse({"record", "--controller", "x.so", sr1_scenario.string()}).err, HasSubstr("'x.so' is not NAME=LIB"));
  EXPECT_THAT(rehearse({"record", "--model", quadruped_, sr1_scenario.string()}).err, HasSubstr("a run has one of them"));
  EXPECT_THAT(rehearse({"record", "--save-scenario", "x.yaml", sr1_scenario.string()}).err, HasSubstr("expected --model"));
  EXPECT_THAT(rehearse({"record", "--model", "none.urdf"}).err, HasSubstr("none.urdf"));
  EXPECT_TRUE(is_empty());
}

TEST_F(RecordModel, JsonHasTheRunAndAnErrorIsAnObjectToo) {
  const auto run = done({"record", "--model", quadruped_, "--duration", "0.01", "--json"}).json();
  EXPECT_EQ(run["schema"], 1);
  EXPECT_EQ(run["ticks"], 10);
  EXPECT_EQ(run["trace"], "quadruped.mcap");
  EXPECT_TRUE(run["failure"].is_null());
  const auto failed = rehearse({"record", "none.yaml", "--json"});
  EXPECT_EQ(failed.status, 2);
  EXPECT_EQ(failed.json()["errors"].size(), 1u);
  EXPECT_EQ(rehearse({"info", "--json", "--love"}).json()["schema"], 1);
}

TEST_F(RecordModel, WhatAControllerWroteIsPartOfItsFailure) {
  const Outcome outcome = rehearse({"record", pendulum(MISBEHAVING, "say-and-refuse").string()});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.err, HasSubstr("initialize() returned false; it wrote: the robot has no joint KNEE"));
  EXPECT_THAT(rehearse({"record", pendulum(MISBEHAVING, "say-and-throw 3").string()}).err,
              HasSubstr("in control() at tick 3 (0.003 s); it wrote: "));
}

}  // namespace
}  // namespace rehearse::test
