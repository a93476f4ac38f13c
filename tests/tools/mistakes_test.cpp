// The commonest mistakes of a user: the text of `rehearse check`, and that of a test with EXPECT_MATCHES_GOLDEN.
#include <gmock/gmock.h>

#include <algorithm>

#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Matcher;
using ::testing::Not;
using ::testing::StartsWith;

/// A project with the scenario fall.yaml, which `check` and the test Macro.Falls compare with the golden Macro.Falls.
class Mistake : public Command {
 protected:
  Mistake() { fs::create_directory(folder() / "golden"); }

  void scenario(const std::string& library, const std::string& options, const std::string& joint = "hinge",
                const std::string& model = (fixtures / "models/pendulum.urdf").string()) const {
    write("fall.yaml", "rehearse: 1\ngolden: Macro.Falls\nduration: 0.05\nbodies:\n  - name: Pendulum\n    model: " +
                           model + "\n    joints: {" + joint +
                           ": 20 deg}\n    controllers:\n      - name: Swing\n        library: " + library +
                           "\n        options: \"" + options + "\"\n");
  }
  std::string checked(const std::string& environment = "") const {
    const Outcome outcome = rehearse({"check", "--no-report", "fall.yaml"}, environment);
    EXPECT_NE(outcome.status, 0);
    return outcome.out + outcome.err;
  }
  std::string tested(const std::string& environment = "") const {
    const Outcome outcome = run(OWNING_TESTS, {"--gtest_filter=Macro.Falls"}, environment);
    EXPECT_NE(outcome.status, 0);
    return outcome.out + outcome.err;
  }
  /// Both texts must contain that.
  void expect_both(const Matcher<const std::string&>& text, const std::string& environment = "") const {
    EXPECT_THAT(checked(environment), text);
    EXPECT_THAT(tested(environment), text);
  }
};

TEST_F(Mistake, AWrongJointNameIsCorrected) {
  scenario(MISBEHAVING, "nothing 0", "hing");
  expect_both(HasSubstr("fall.yaml:7:14: error: Pendulum has no joint 'hing' (did you mean 'hinge'?)"));
}

TEST_F(Mistake, AForgottenBuildIsAdvised) {
  write("CMakeLists.txt", "project(fall)\n");
  scenario("Swing", "");
  expect_both(
      HasSubstr("fall.yaml:10:18: error: controller library 'Swing' not found (build it first: cmake -S . -B build "
                "&& cmake --build build)"));
}

TEST_F(Mistake, AForgottenGoldenIsAdvised) {
  scenario(MISBEHAVING, "nothing 0");
  expect_both(AllOf(HasSubstr("there is no golden golden/Macro.Falls.mcap"),
                    HasSubstr("\nif it is right: rehearse golden accept Macro.Falls\n")));
}

TEST_F(Mistake, AGoldenOfNearlyTheNameOfItsTestIsNamed) {
  scenario(MISBEHAVING, "nothing 0");
  EXPECT_EQ(rehearse({"check", "fall.yaml"}, "REHEARSE_GOLDEN=new").status, 0);
  for (const char* ending : {".mcap", ".txt"})
    fs::rename(folder() / ("golden/Macro.Falls" + std::string(ending)),
               folder() / ("golden/Macro.Fals" + std::string(ending)));
  const auto names_it = HasSubstr(
      "there is no golden golden/Macro.Falls.mcap (golden 'Macro.Fals' has nearly that name, and no test of that name "
      "is known: correct the test's name, or rename golden/Macro.Fals.mcap and its .txt)");
  EXPECT_THAT(tested(), names_it);
  EXPECT_THAT(tested("CI=true"), names_it);
  std::string other = read_file(folder() / "fall.yaml");
  write("other.yaml", other.replace(other.find("Macro.Falls"), 11, "Macro.Fals"));
  EXPECT_THAT(tested(), Not(HasSubstr("nearly that name"))) << "a scenario names it";
  fs::rename(folder() / "golden/Macro.Fals.mcap", folder() / "golden/All-Fall.Ends-1.mcap");
  fs::create_directories(folder() / "tests/tools");  // as this program names its source
  fs::copy_file(fixtures / "../tests/tools/owning_tests.cpp", folder() / "tests/tools/owning_tests.cpp");
  EXPECT_THAT(run(OWNING_TESTS, {"--gtest_filter=All/Fall.Ends/0"}).out,
              AllOf(HasSubstr("there is no golden golden/All-Fall.Ends-0.mcap"), Not(HasSubstr("nearly that name"))))
      << "its test is in the same source";
}

TEST_F(Mistake, AForgottenGoldenInCiGetsAdviceThatWorksThere) {
  scenario(MISBEHAVING, "nothing 0");
  expect_both(AllOf(HasSubstr("there is no golden golden/Macro.Falls.mcap"),
                    HasSubstr("\nif it is right: make this run on a machine of yours, accept it there, and commit the "
                              "golden Macro.Falls"),
                    Not(HasSubstr("golden accept")), Not(HasSubstr("REHEARSE_GOLDEN"))),
              "CI=true");
}

TEST_F(Mistake, AGoldenThatGitLfsHasNotFetchedIsNamedSo) {
  scenario(MISBEHAVING, "nothing 0");
  EXPECT_EQ(rehearse({"check", "fall.yaml"}, "REHEARSE_GOLDEN=new").status, 0);
  fs::copy_file(fixtures / "broken/trace_git_lfs_pointer.mcap", folder() / "golden/Macro.Falls.mcap",
                fs::copy_options::overwrite_existing);
  expect_both(
      AllOf(HasSubstr("golden/Macro.Falls.mcap: error: it is a git-lfs pointer, not the recording that it stands for "
                      "(run: git lfs pull)"),
            Not(HasSubstr("golden accept"))));
  EXPECT_EQ(rehearse({"check", "fall.yaml"}).status, 2);
}

TEST_F(Mistake, AMisspeltSeriesOfAnExpectationIsBadInput) {
  scenario(MISBEHAVING, "nothing 0");
  EXPECT_EQ(rehearse({"check", "fall.yaml"}, "REHEARSE_GOLDEN=new").status, 0);
  write("fall.yaml", read_file(folder() / "fall.yaml") + "expect: [{channel: Pendulum/hing/q, above: 0}]\n");
  expect_both(AllOf(HasSubstr("fall.yaml:12:20: error: no run of this scenario has a series 'Pendulum/hing/q' (the "
                              "nearest are Pendulum/hinge/q, "),
                    Not(HasSubstr("differs")), Not(HasSubstr("golden accept"))));
  EXPECT_EQ(rehearse({"check", "fall.yaml"}).status, 2);
  for (const char* ending : {".mcap", ".txt"}) fs::remove(folder() / ("golden/Macro.Falls" + std::string(ending)));
  EXPECT_EQ(rehearse({"check", "fall.yaml"}).status, 2) << "without a golden as well";
  EXPECT_FALSE(exists("rehearse-pending/Macro.Falls.mcap"));
}

TEST_F(Mistake, AMisspeltChannelOfAToleranceIsBadInput) {
  scenario(MISBEHAVING, "nothing 0");
  EXPECT_EQ(rehearse({"check", "fall.yaml"}, "REHEARSE_GOLDEN=new").status, 0);
  const std::string plain = read_file(folder() / "fall.yaml");
  const auto tolerance = [&](const std::string& channel) {
    write("fall.yaml", plain + "tolerances: [{channel: \"" + channel + "\", atol: 1}]\n");
  };
  tolerance("Pendulum/hing/q");
  for (int simulated_then_proved = 0; simulated_then_proved < 2; ++simulated_then_proved) {
    expect_both(
        HasSubstr("fall.yaml:12:24: error: no run of this scenario has a series 'Pendulum/hing/q' (the nearest "
                  "are Pendulum/hinge/q, "));
    EXPECT_EQ(rehearse({"check", "fall.yaml"}).status, 2);
  }
  for (const char* unclear : {"Pendulum/*/qq", "Pendulum/Swing/variable/phase", "contacts/Pendulum/rod/Floor/Floor"}) {
    tolerance(unclear);
    const Outcome warned = rehearse({"check", "fall.yaml"});
    EXPECT_EQ(warned.status, 0) << unclear;
    EXPECT_THAT(warned.out, HasSubstr("applies to nothing")) << unclear;
  }
}

TEST_F(Mistake, AGoldenOfAnotherMachinesArithmeticIsTold) {
  scenario(MISBEHAVING, "nothing 0");
  EXPECT_EQ(rehearse({"check", "fall.yaml"}, "REHEARSE_GOLDEN=new REHEARSE_PIN=off").status, 0);
  std::string text = read_file(folder() / "fall.yaml");
  write("fall.yaml", text.replace(text.find("20 deg"), 6, "20.0001 deg"));
  expect_both(HasSubstr("pinned was \"no (REHEARSE_PIN=off)\" and is \"yes\": everything may differ for that alone"));
}

TEST_F(Mistake, ARefusalRepeatsTheControllersReason) {
  scenario(MISBEHAVING, "say-and-refuse");
  expect_both(AllOf(HasSubstr("controller 'Pendulum/Swing' refuses to take part: initialize() returned false"),
                    HasSubstr("the robot has no joint KNEE"), Not(HasSubstr("golden accept"))));
}

TEST_F(Mistake, ACrashComesFirstAndLeadsToTheDebugger) {
  scenario(MISBEHAVING, "crash 3");
  expect_both(AllOf(HasSubstr("controller 'Pendulum/Swing' crashed: segmentation fault"),
                    HasSubstr("at tick 3 (0.003 s)"), Not(HasSubstr("golden accept"))));
  EXPECT_THAT(checked(), ContainsRegex("^fall: misbehaving.cpp:[0-9]+: controller 'Pendulum/Swing' crashed"));
  EXPECT_THAT(checked(), HasSubstr("\nstop there in gdb: rehearse replay rehearse-pending/Macro.Falls.mcap --gdb\n"));
}

TEST_F(Mistake, ANumberThatIsNotFiniteComesFirstWithItsJointAndTick) {
  const std::string cause = "controller 'Pendulum/Swing' wrote nan into u of joint 'hinge' at tick 3 (0.003 s); ";
  const auto comes_first = AllOf(HasSubstr(cause), Not(HasSubstr("golden accept")), Not(HasSubstr("correct the exp")));
  scenario(MISBEHAVING, "nan 3");
  EXPECT_THAT(checked(), AllOf(StartsWith("fall: " + cause), comes_first, HasSubstr("--gdb --tick 3\n")));
  EXPECT_THAT(tested(), HasSubstr(cause));
  scenario(MISBEHAVING, "nothing 0");
  EXPECT_EQ(rehearse({"check", "fall.yaml"}, "REHEARSE_GOLDEN=new").status, 0);
  scenario(MISBEHAVING, "nan 3");
  for (const char* expected : {"", "expect: [{channel: Pendulum/hinge/q, above: 100, at: end}]\n"}) {
    write("fall.yaml", read_file(folder() / "fall.yaml") + expected);
    EXPECT_THAT(checked(), AllOf(StartsWith("fall: " + cause), comes_first, HasSubstr("--gdb --tick 3\n")));
    EXPECT_THAT(tested(), comes_first);
    EXPECT_EQ(rehearse({"check", "fall.yaml", "--json"}).json()["code"], "controller.not_finite");
  }
}

/// `check` of a project with a golden, of which a controller fails in initialize().
class MistakeInInitialize : public Mistake,
                            public ::testing::WithParamInterface<std::pair<const char*, const char*>> {};

TEST_P(MistakeInInitialize, IsTheOnlySentence) {
  const auto [deed, cause] = GetParam();
  const std::string expected = "expect: [{channel: Pendulum/hinge/q, below: 100, at: end}]\n";
  const auto written = [&](const std::string& options, const char* golden) {
    scenario(MISBEHAVING, options);
    std::string text = read_file(folder() / "fall.yaml") + expected;
    if (!*golden) text.erase(text.find("golden: "), text.find("duration") - text.find("golden: "));
    write("fall.yaml", text);
  };
  written("nothing 0", "golden");
  EXPECT_EQ(rehearse({"check", "fall.yaml"}, "REHEARSE_GOLDEN=new").status, 0);
  for (const char* golden : {"golden", ""}) {
    written(deed, golden);
    const std::string text = checked();
    EXPECT_THAT(text, ContainsRegex("^fall: " + std::string(cause)));
    EXPECT_LE(std::ranges::count(text, '\n'), 6) << text;
    const std::size_t first = text.find("initialize()");
    ASSERT_NE(first, std::string::npos) << text;
    EXPECT_EQ(text.find("initialize()", first + 1), std::string::npos) << "the sentence is repeated: " << text;
    EXPECT_THAT(text, AllOf(Not(HasSubstr("reads other inputs")), Not(HasSubstr("no such series")),
                            Not(HasSubstr("golden accept")), Not(HasSubstr("correct the exp"))));
    EXPECT_EQ(rehearse({"check", "fall.yaml", "--json"}).json()["code"], "controller.failed");
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, MistakeInInitialize,
    ::testing::Values(std::pair("crash", "misbehaving.cpp:[0-9]+: controller 'Pendulum/Swing' crashed: "),
                      std::pair("throw", "controller 'Pendulum/Swing' threw"),
                      std::pair("say-and-refuse", "controller 'Pendulum/Swing' refuses to take part: ")),
    [](const auto& info) { return info.param.first == std::string("say-and-refuse") ? "refuse" : info.param.first; });

TEST_F(Mistake, ACrashBesideAGoldenIsNotAdvisedForAcceptance) {
  scenario(MISBEHAVING, "nothing 0");
  EXPECT_EQ(rehearse({"check", "fall.yaml"}, "REHEARSE_GOLDEN=new").status, 0);
  scenario(MISBEHAVING, "crash 3");
  expect_both(AllOf(HasSubstr("controller 'Pendulum/Swing' crashed"), Not(HasSubstr("golden accept"))));
  EXPECT_THAT(checked(), HasSubstr("\nstop there in gdb: rehearse replay rehearse-pending/Macro.Falls.mcap --gdb\n"));
  EXPECT_THAT(checked("CI=true"), Not(HasSubstr("--gdb")));
  const Outcome outcome = rehearse({"check", "fall.yaml"});
  const std::string lines = outcome.out + outcome.err;
  EXPECT_LE(std::ranges::count(lines, '\n'), 5) << lines;
  const std::string all = rehearse({"check", "fall.yaml", "--verbose"}).out;
  EXPECT_THAT(all, HasSubstr("bit-equal: "));
}

/// A golden whose files were damaged by hand, by a merge or by a copy.
class DamagedGolden : public Mistake, public ::testing::WithParamInterface<const char*> {};

TEST_P(DamagedGolden, NamesTheCauseAndTheWayBackInItsFirstLine) {
  const std::string damage = GetParam(), recording = "golden/Macro.Falls.mcap", digest = "golden/Macro.Falls.txt";
  scenario(MISBEHAVING, "nothing 0");
  EXPECT_EQ(rehearse({"check", "fall.yaml"}, "REHEARSE_GOLDEN=new").status, 0);
  if (damage == "NoDigest") fs::remove(folder() / digest);
  if (damage == "EditedDigest") write(digest, read_file(folder() / digest) + "checked by me\n");
  if (damage == "ConflictMarkers") write(digest, "<<<<<<< HEAD\n" + read_file(folder() / digest) + "=======\n");
  if (damage == "CutShort") fs::resize_file(folder() / recording, fs::file_size(folder() / recording) / 2);
  const std::string file = damage == "CutShort" ? recording : digest, text = checked();
  const std::string first = text.substr(0, text.find('\n'));
  EXPECT_THAT(first, HasSubstr(file));
  EXPECT_THAT(first, HasSubstr(damage == "CutShort"   ? "truncated at byte "
                               : damage == "NoDigest" ? "the digest of golden/Macro.Falls.mcap is missing"
                                                      : "the digest doesn't describe golden/Macro.Falls.mcap"));
  EXPECT_THAT(text, ContainsRegex("git checkout -- [^\n]*" + file + "[^\n]* brings back what was committed"));
  EXPECT_LE(std::ranges::count(text, '\n'), 6) << text;
  EXPECT_THAT(tested(), ContainsRegex("git checkout -- [^\n]*" + file));
}

INSTANTIATE_TEST_SUITE_P(By, DamagedGolden,
                         ::testing::Values("NoDigest", "EditedDigest", "ConflictMarkers", "CutShort"),
                         [](const auto& info) { return info.param; });

TEST_F(Mistake, LimitsInDegreesAreWarnedOf) {
  std::string model = read_file(fixtures / "models/pendulum.urdf");
  model.replace(model.find("continuous"), 10, "revolute");
  model.insert(model.find("<axis"), "<limit lower='-90' upper='90' effort='1' velocity='1'/>");
  write("degrees.urdf", model);
  scenario(MISBEHAVING, "nothing 0", "hinge", "degrees.urdf");
  expect_both(
      HasSubstr("degrees.urdf:22: warning: joint 'hinge' has limits of -90 and 90 rad, which look like degrees (in "
                "radians: -1.5708 and 1.5708)"));
}

}  // namespace
}  // namespace rehearse::test
