// rehearse record --model: a robot without a scenario; and --json.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

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
  const std::vector<std::string> words = {"record",    "--model",    pendulum, "--controller",
                                          MISBEHAVING, "--duration", "0.02"};
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

TEST_F(RecordModel, TellsHowLongControlTookAndWarnsBeyondADeadline) {
  const std::string pendulum = (fixtures / "models/pendulum.urdf").string();
  const std::vector<std::string> words = {"record",     "--model", pendulum, "--controller", MISBEHAVING,
                                          "--duration", "0.02",    "-o",     "a.mcap"};
  const auto with = [&](std::vector<std::string> all, const std::vector<std::string>& more) {
    all.insert(all.end(), more.begin(), more.end());
    return rehearse(all);
  };
  const Outcome quick = with(words, {"--deadline", "100000"});
  EXPECT_THAT(quick.out, ContainsRegex("control\\(\\) of [A-Za-z/]+: median [0-9.e+]+ µs, 99.9 % within [0-9.e+]+ µs, "
                                       "longest [0-9.e+]+ µs at tick [0-9]+: [0-9.e+-]+ % of the period"));
  EXPECT_THAT(quick.err, Not(HasSubstr("deadline")));
  EXPECT_THAT(with(words, {"--deadline", "1e-6"}).err, HasSubstr("longer than the deadline of 0.001 µs"));
  const Outcome replayed = rehearse({"replay", "a.mcap", "--deadline", "1e-6"});
  EXPECT_EQ(replayed.status, 0) << "a remark alone";
  EXPECT_THAT(replayed.out, HasSubstr("control() of "));
  EXPECT_THAT(replayed.err, HasSubstr("longer than the deadline of 0.001 µs"));
  EXPECT_THAT(done({"replay", "a.mcap", "--json"}).out, HasSubstr("\"control_times\": ["));
}

TEST_F(RecordModel, ChecksTellHowLongControlTook) {
  const std::string pendulum = (fixtures / "models/pendulum.urdf").string();
  done({"record", "--model", pendulum, "--controller", MISBEHAVING, "--duration", "0.02", "--save-scenario", "s.yaml",
        "-o", "a.mcap"});
  std::ofstream(folder() / "s.yaml", std::ios::app) << "expect:\n  - {channel: \"*/q\", below: 9}\n";
  const Outcome brief = done({"check", "s.yaml", "--deadline", "100000"});
  EXPECT_THAT(brief.out, Not(HasSubstr("control() of ")));
  EXPECT_THAT(brief.err, Not(HasSubstr("deadline")));
  const Outcome verbose = rehearse({"check", "s.yaml", "-v", "--deadline", "1e-6"});
  EXPECT_EQ(verbose.status, 0) << "a remark alone";
  EXPECT_THAT(verbose.out, HasSubstr("control() of "));
  EXPECT_THAT(verbose.err, HasSubstr("longer than the deadline of 0.001 µs"));
  EXPECT_THAT(done({"check", "s.yaml", "--json"}).out, HasSubstr("\"longest_tick\": "));
}

TEST_F(RecordModel, TakesTheOptionsOfEveryVerbThatLoadsAModel) {
  fs::create_directories(folder() / "meshes");
  fs::create_directories(folder() / "aside");
  write("r.urdf",
        "<robot name='r'><link name='base'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' "
        "ixz='0' iyz='0'/></inertial><visual><geometry><mesh filename='package://parts/none.stl'/></geometry></visual>"
        "</link><link name='arm'/><joint name='j' type='revolute'><parent link='base'/><child link='arm'/>"
        "<axis xyz='0 1 0'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>");
  const std::vector<std::string> loading{"--package", "parts=meshes", "--default-mass", "0.5",
                                         "--allow-missing-meshes"};
  const auto with = [&](std::vector<std::string> words) {
    words.insert(words.end(), loading.begin(), loading.end());
    return rehearse(words);
  };
  EXPECT_EQ(rehearse({"record", "--model", "r.urdf", "--duration", "0.01"}).status, 2);
  const Outcome recorded = with({"record", "--model", "r.urdf", "--duration", "0.01", "--solver", "exact",
                                 "--save-scenario", "aside/s.yaml", "-o", "a.mcap"});
  EXPECT_EQ(recorded.status, 0) << recorded.err;
  const std::string saved = read_file(folder() / "aside/s.yaml");
  EXPECT_THAT(saved, HasSubstr("solver: {method: exact}\n"));
  EXPECT_THAT(
      saved,
      HasSubstr("packages: {\"parts\": \"../meshes\"}\n    default_mass: 0.5\n    allow_missing_meshes: true\n"));
  EXPECT_EQ(with({"record", "--model", "r.urdf", "--duration", "0.01", "--solver", "exact", "-o", "b.mcap"}).status, 0);
  EXPECT_EQ(rehearse({"diff", "a.mcap", "b.mcap"}).status, 0);
  EXPECT_EQ(with({"inspect", "r.urdf"}).status, 0);
  EXPECT_EQ(with({"render", "r.urdf", "-o", "r.png"}).status, 0);
  EXPECT_THAT(rehearse({"record", "aside/s.yaml", "--solver", "exact"}).err, HasSubstr("go with --model"));
  EXPECT_THAT(rehearse({"record", "--model", "r.urdf", "--solver", "best"}).err, HasSubstr("--solver"));
}

TEST_F(RecordModel, ALibraryOfASavedScenarioIsFoundFromAnyFolder) {
  fs::create_directories(folder() / "scn");
  fs::create_directories(folder() / "lib");
  fs::create_directories(folder() / "aside/deep");
  fs::copy_file(fixtures / "models/pendulum.urdf", folder() / "scn/r.urdf");
  fs::copy_file(MISBEHAVING, folder() / "lib/libHold.so");
  done({"record", "--model", "scn/r.urdf", "--controller", "lib/libHold.so", "--save-scenario", "scn/s.yaml",
        "--duration", "0.02", "-o", "scn/t.mcap"});
  const auto from = [&](const fs::path& within, std::vector<std::string> words) {
    const std::string line = "cd " + quoted((folder() / within).string()) + " && " + quoted(command.string());
    words.insert(words.begin(), {"-c", line + " \"$@\"", "bash"});
    const Outcome outcome = run("bash", words, "REHEARSE_CALL_STACK=never");
    EXPECT_EQ(outcome.status, 0) << within << ": " << words[3] << ": " << outcome.out << outcome.err;
  };
  for (const fs::path within : {".", "scn", "lib", "aside/deep", "/"}) {
    const fs::path base = within == "/" ? folder() / "scn" : (folder() / "scn").lexically_relative(folder() / within);
    const std::string trace = (base / "t.mcap").string(), scenario = (base / "s.yaml").string();
    from(within, {"replay", trace});
    from(within, {"replay", trace, "--tick", "3"});
    if (within != "/") from(within, {"check", scenario, "--golden", trace});
    from(within, {"diff", trace, trace});
  }
  from("aside/deep", {"audit", "../../scn/t.mcap"});
  from("scn", {"audit", "t.mcap"});
  const Outcome stepped =
      run("bash", {"-c", "echo 'print pendulum/hinge/u' | " + quoted(command.string()) + " step scn/t.mcap"});
  EXPECT_EQ(stepped.status, 0) << stepped.err;
}

TEST_F(RecordModel, OptionsThatDontBelongTogetherAreRefused) {
  EXPECT_THAT(rehearse({"record", "--controller", "x.so", sr1_scenario.string()}).err,
              HasSubstr("'x.so' is not NAME=LIB"));
  EXPECT_THAT(rehearse({"record", "--model", quadruped_, sr1_scenario.string()}).err,
              HasSubstr("a run has one of them"));
  EXPECT_THAT(rehearse({"record", "--save-scenario", "x.yaml", sr1_scenario.string()}).err,
              HasSubstr("expected --model"));
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
