// What is proved is what a simulation gives, and nothing is proved if the world may be another one.
#include <gmock/gmock.h>
#include <rehearse/compare.h>
#include <rehearse/renderer.h>
#include <rehearse/session.h>

#include <dlfcn.h>
#include <link.h>
#include <algorithm>

#include "command.h"
#include "standing_robot.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

const Simulation simulation{record, run_plant, describe_plant, record_from};

/// A fixture's scenario beside its golden.
class FixtureProof : public ::testing::TestWithParam<std::string> {
 protected:
  FixtureProof() { setenv("REHEARSE_CONTROLLER_PATH", SAMPLE_CONTROLLERS, 1); }
  testing::TemporaryFolder folder_;
};

std::vector<std::string> scenarios_with_golden() {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(FIXTURES_DIR "/scenarios"))
    if (test::read_file(entry.path()).find("\ngolden: ") != std::string::npos)
      names.push_back(entry.path().stem().string());
  std::ranges::sort(names);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Of, FixtureProof, ::testing::ValuesIn(scenarios_with_golden()),
                         [](const auto& of) { return of.param; });

TEST_P(FixtureProof, IsWhatTheSimulationGives) {
  const auto scenario = Scenario::load(fs::path(FIXTURES_DIR "/scenarios") / (GetParam() + ".yaml"));
  ASSERT_TRUE(scenario.ok()) << to_string(scenario.errors());
  const fs::path golden = fs::path(GOLDENS) / (scenario->golden + ".mcap"), actual = folder_ / "actual.mcap";
  CheckOptions options;
  options.certificates = folder_ / "proofs";
  const auto simulated = check_scenario(*scenario, golden, actual, options, simulation);
  ASSERT_TRUE(simulated.ok()) << to_string(simulated.errors());
  EXPECT_FALSE(simulated->proved);
  EXPECT_EQ(simulated->simulated_from, 0);
  EXPECT_EQ(simulated->not_proved, "no check has simulated this golden here before");
  ASSERT_EQ(simulated->closed, LevelState::equal) << simulated->verdict.text();

  const auto proved = check_scenario(*scenario, golden, actual, options, simulation);
  ASSERT_TRUE(proved.ok()) << to_string(proved.errors());
  EXPECT_TRUE(proved->proved) << proved->not_proved;
  EXPECT_TRUE(proved->equal());
  EXPECT_EQ(proved->controller, LevelState::equal);
  EXPECT_EQ(proved->plant, LevelState::proved);
  EXPECT_EQ(proved->closed, LevelState::proved);
  EXPECT_THAT(proved->verdict.text(),
              StartsWith("proved without simulating: the world is the one that made the golden, and "
                         "the controllers repeat its commands"));
  EXPECT_EQ(proved->simulated_from, std::nullopt);
  ASSERT_EQ(proved->expectations.size(), simulated->expectations.size());
  for (std::size_t i = 0; i < proved->expectations.size(); ++i) {
    EXPECT_EQ(proved->expectations[i].text, simulated->expectations[i].text);
    EXPECT_TRUE(proved->expectations[i].holds);
  }
  EXPECT_FALSE(fs::exists(actual));
}

/// The second half is simulated from a checkpoint; before it the golden is copied.
TEST_P(FixtureProof, ARunThatIsSimulatedInPartIsTheWholeRun) {
  const auto scenario = Scenario::load(fs::path(FIXTURES_DIR "/scenarios") / (GetParam() + ".yaml"));
  ASSERT_TRUE(scenario.ok()) << to_string(scenario.errors());
  const auto golden = Trace::load_in_pieces(fs::path(GOLDENS) / (scenario->golden + ".mcap"), [](const Trace&) {});
  ASSERT_TRUE(golden.ok());
  const auto run = record_from(*scenario, *golden, scenario->ticks() * 3 / 4 + 7, folder_ / "actual.mcap");
  ASSERT_TRUE(run.ok()) << to_string(run.errors());
  EXPECT_EQ(run->summary.ticks, scenario->ticks());
  const auto compared = compare(golden->file(), folder_ / "actual.mcap", scenario->tolerances, {});
  ASSERT_TRUE(compared.ok()) << to_string(compared.errors());
  EXPECT_TRUE(compared->equal) << table(*compared);
}

/// SR1 that stands, and its golden, which a check has simulated.
class Proof : public ::testing::Test {
 protected:
  Proof() {
    robot_.record_golden();
    options_.certificates = robot_.file("proofs");
    EXPECT_EQ(check().closed, LevelState::equal);
  }
  CheckReport check() const {
    auto report = robot_.check(options_, simulation);
    EXPECT_TRUE(report.ok()) << to_string(report.errors());
    return report.ok() ? *std::move(report) : CheckReport();
  }

  StandingRobot robot_;
  CheckOptions options_;
};

TEST_F(Proof, IsThereOnceACheckHasSimulatedTheGolden) {
  EXPECT_TRUE(check().proved);
  robot_.apply({"scenario.yaml", "seed: 7", "seed: 7\nname: standing\ntolerances: [{channel: \"*\", atol: 1}]"});
  EXPECT_TRUE(check().proved) << "names and tolerances don't change the world";
}

/// The bytes that this process has read so far, from any file.
std::uint64_t bytes_read() {
  std::ifstream counts("/proc/self/io");
  std::string name;
  std::uint64_t bytes = 0;
  counts >> name >> bytes;
  return name == "rchar:" ? bytes : 0;
}

TEST_F(Proof, ReadsTheGoldenAndTheControllerOnceAndLittleElse) {
  ASSERT_TRUE(check().proved);  // it has read what doesn't change in a process
  const std::uint64_t before = bytes_read();
  ASSERT_GT(before, 0u);
  EXPECT_TRUE(check().proved);
  const std::uintmax_t needed =
      fs::file_size(robot_.file("golden.mcap")) + fs::file_size(fs::path(VERDICT_CONTROLLERS) / "StandWith_none.so");
  const std::uintmax_t scenario = fs::file_size(robot_.file("sr1.urdf")) + fs::file_size(robot_.file("scenario.yaml"));
  constexpr std::uintmax_t little =
      24 * 1024;  // certificate, headers of the library; a list of the process's memory has 60 kB
  EXPECT_LT(bytes_read() - before, needed + scenario + little);
}

TEST_F(Proof, WarnsOfToleranceRulesThatApplyToNothing) {
  robot_.apply({"scenario.yaml", "seed: 7", "seed: 7\ntolerances: [{channel: SR1/*/q, atol: 1}]"});
  EXPECT_TRUE(check().proved);
  EXPECT_THAT(check().remarks, IsEmpty());
  robot_.apply({"scenario.yaml", "SR1/*/q", "SR2/*/q"});
  for (int again = 0; again < 2; ++again) {
    const CheckReport report = check();
    EXPECT_TRUE(report.proved);
    EXPECT_THAT(report.remarks, ElementsAre(HasSubstr("the tolerance of 'SR2/*/q' applies to nothing")));
  }
}

TEST_F(Proof, OfThePlantAloneNeedsNoReplay) {
  options_.controller = options_.closed = false;
  const CheckReport report = check();
  EXPECT_TRUE(report.proved);
  EXPECT_EQ(report.plant, LevelState::proved);
  EXPECT_EQ(report.controller, LevelState::not_compared);
  EXPECT_EQ(report.verdict.text(), "proved without simulating: the world is the one that made the golden");
}

TEST_F(Proof, IsNoneForAnotherGoldenOfTheSameWorld) {
  RecordOptions original;
  original.libraries["Stand"] = "StandWith_gain";
  robot_.record_golden(original);
  const CheckReport report = check();
  EXPECT_EQ(report.not_proved, "no check has simulated this golden here before");
  EXPECT_EQ(report.closed, LevelState::differs);
}

TEST_F(Proof, NamesWhatHasChanged) {
  robot_.apply({"sr1.urdf", R"(<mass value="5.1"/>)", R"(<mass value="5.1000"/>)"});
  EXPECT_EQ(check().not_proved, "sr1.urdf changed since its golden was simulated");
  robot_.apply({"scenario.yaml", "friction: 1}", "friction: 1, erp: 0.2}"});
  EXPECT_THAT(check().not_proved, HasSubstr("the scenario"));
}

/// Another program loads other libraries; none of them has changed.
TEST_F(Proof, OfAnotherProgramIsCalledThat) {
  options_.certificates = robot_.file("proofs of others");
  const auto check_by = [&](const std::string& program, const std::string& fact) {
    const Simulation other{record, run_plant,
                           [&](const Scenario& of) {
                             auto plant = describe_plant(of);
                             if (!plant) return plant;
                             plant->erase("the program proof_test");
                             plant->emplace("the program " + program, "1");
                             plant->emplace("the library lib" + program + ".so", "1");
                             if (!fact.empty()) plant->emplace(fact, "1");
                             return plant;
                           },
                           record_from};
    const auto report = robot_.check(options_, other);
    EXPECT_TRUE(report.ok()) << to_string(report.errors());
    return report ? report->not_proved : "";
  };
  EXPECT_EQ(check_by("hold_test", ""), "no check has simulated this golden here before");
  EXPECT_EQ(check_by("simulate", ""), "the program hold_test simulated its golden, and this program has not");
  EXPECT_EQ(check_by("simulate", ""), "");
  EXPECT_THAT(check_by("hold_test", "the weather"), HasSubstr("the weather changed since its golden was simulated"));
}

TEST_F(Proof, IsNotWantedByAScenario) {
  robot_.apply({"scenario.yaml", "seed: 7", "seed: 7\nsimulate: always"});
  const CheckReport report = check();
  EXPECT_FALSE(report.proved);
  EXPECT_EQ(report.closed, LevelState::equal);
  EXPECT_EQ(report.not_proved, "the scenario asks for it");
}

TEST_F(Proof, ExpectationsAreJudgedOnTheGolden) {
  robot_.apply({"scenario.yaml", "seed: 7", "seed: 7\nexpect: [{channel: SR1/WAIST/position/z, above: 0.5}]"});
  const CheckReport held = check();
  EXPECT_TRUE(held.proved);
  EXPECT_THAT(held.verdict.text(), HasSubstr("; the expectation holds: SR1/WAIST/position/z above 0.5 m"));
  robot_.apply({"scenario.yaml", "above: 0.5", "above: 0.9"});
  const CheckReport violated = check();
  EXPECT_FALSE(violated.within());
  EXPECT_THAT(violated.verdict.text(), StartsWith("expected SR1/WAIST/position/z above 0.9 m"));
}

TEST_F(Proof, IsThereForAGoldenWithSamplesOfTheState) {
  robot_.apply({"scenario.yaml", "seed: 7", "seed: 7\ngolden: {state: 100 Hz}"});
  robot_.keep_samples(100.0);
  const CheckReport simulated = check();
  EXPECT_EQ(simulated.not_proved, "no check has simulated this golden here before");
  EXPECT_EQ(simulated.closed, LevelState::equal) << simulated.verdict.text();
  EXPECT_TRUE(check().proved);

  options_.run.libraries["Stand"] = "StandWith_last_part";
  const CheckReport late = check();
  EXPECT_EQ(late.plant, LevelState::proved);
  EXPECT_EQ(late.simulated_from, 300);
  EXPECT_EQ(late.first->tick, 500);
  EXPECT_EQ(late.first->stage, Stage::controller);
}

TEST_F(Proof, IsNoneIfTheGoldenLacksStateThatIsJudged) {
  robot_.keep_samples(100.0);
  robot_.apply({"scenario.yaml", "seed: 7", "seed: 7\ngolden: {state: 100 Hz}"});
  EXPECT_TRUE((check(), check()).proved);
  robot_.apply({"scenario.yaml", "seed: 7", "seed: 7\nexpect: [{channel: SR1/WAIST/position/z, above: 0.5}]"});
  const CheckReport report = check();
  EXPECT_EQ(report.not_proved, "the golden keeps other samples of the state than the scenario asks for");
  EXPECT_EQ(report.closed, LevelState::equal);
  robot_.apply({"scenario.yaml", "golden: {state: 100 Hz}", ""});
  EXPECT_EQ(check().not_proved, "the golden keeps other samples of the state than the scenario asks for");
}

TEST_F(Proof, LinesThatTheControllersWriteCount) {
  options_.run.libraries["Stand"] = "StandWith_words";
  const CheckReport report = check();
  EXPECT_FALSE(report.proved);
  EXPECT_TRUE(report.within());
}

TEST_F(Proof, ALateDifferenceIsSimulatedFromACheckpointBefore) {
  options_.run.libraries["Stand"] = "StandWith_last_part";
  const CheckReport report = check();
  EXPECT_EQ(report.plant, LevelState::proved);
  EXPECT_EQ(report.closed, LevelState::differs);
  EXPECT_EQ(report.simulated_from, 300);  // a picture and a half before tick 500
  EXPECT_EQ(report.first->tick, 500);
}

TEST_F(Proof, ThatWasWrongFailsLoudlyIfTheCheckIsInTheSample) {
  const auto broken_record = [](const Scenario& of, const fs::path& trace, const RecordOptions& with) {
    Scenario other = of;
    other.gravity.z() -= 0.01;
    return record(other, trace, with);
  };
  options_.sampled = 100;
  EXPECT_TRUE(check().proved);
  const auto report = robot_.check(options_, {broken_record, run_plant, describe_plant, record_from});
  ASSERT_TRUE(report.ok());
  EXPECT_FALSE(report->within());
  EXPECT_THAT(
      report->verdict.text(),
      StartsWith("the proof was wrong: it found no change since the golden, but the simulation has another result"));
}

/// `rehearse check` of one scenario, which an earlier check has simulated.
class ProvedByCommand : public test::Command {
 protected:
  enum class Of { sr1_without_cameras, a_camera, a_mesh };
  explicit ProvedByCommand(Of what = Of::sr1_without_cameras)
      : scenario_(what == Of::a_camera ? test::fixtures / "scenarios/tank.yaml"
                  : what == Of::a_mesh ? arm_of_meshes()
                                       : sr1_without_cameras()) {
    done({"record", scenario().string(), "-o", "golden.mcap"});
    EXPECT_EQ(check()["proved"], false);
    EXPECT_EQ(check()["proved"], true);
  }
  const fs::path& scenario() const { return scenario_; }
  nlohmann::json check(const std::string& environment = "", const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"check", scenario().string(), "--golden", "golden.mcap", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const test::Outcome outcome = rehearse(words, environment);
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    return outcome.json();
  }
  void expect_simulated(const nlohmann::json& report, const std::string& reason) const {
    EXPECT_EQ(report["proved"], false);
    EXPECT_EQ(report["levels"]["plant"], "equal");
    EXPECT_THAT(report["not_proved"].get<std::string>(), HasSubstr(reason));
  }
  /// A check with a copy of a library of this process in which a text differs by one bit. `below`: of the test's
  /// folder.
  void expect_simulated_with_other(const std::string& library, const std::string& text,
                                   const fs::path& below = {}) const;

 private:
  /// The beginning of the fixture mesh_arm, before the arm touches anything.
  fs::path arm_of_meshes() const {
    std::string text = test::read_file(test::fixtures / "scenarios/mesh_arm.yaml");
    const auto replace = [&text](std::string_view old, const std::string& with) {
      const std::size_t at = text.find(old);
      EXPECT_NE(at, std::string::npos) << old;
      if (at != std::string::npos) text.replace(at, old.size(), with);
    };
    replace("golden: Grasp.CarriesABlockAside\n", "");
    replace("duration: 3.2 ", "duration: 0.1 ");
    replace("../models", (test::fixtures / "models").string());
    return write("arm.yaml", text.substr(0, text.find("\nhorizon: ")));
  }

  fs::path scenario_;
};

class ProvedWithACamera : public ProvedByCommand {
 protected:
  ProvedWithACamera() : ProvedByCommand(Of::a_camera) {}
};

class ProvedWithAMesh : public ProvedByCommand {
 protected:
  ProvedWithAMesh() : ProvedByCommand(Of::a_mesh) {
    EXPECT_TRUE(Scenario::load(scenario()).ok());  // loads the reader into this process
  }
};

/// This process passes its own pinned environment on.
TEST_F(ProvedByCommand, IsNoneUnlessTheProcessIsPinned) {
  const test::Outcome outcome = rehearse({"check", scenario().string(), "--golden", "golden.mcap", "--json"},
                                         "GLIBC_TUNABLES= GALLIUM_OVERRIDE_CPU_CAPS= LP_NUM_THREADS= REHEARSE_PIN=off");
  const nlohmann::json report = outcome.json();
  EXPECT_EQ(report["proved"], false);
  EXPECT_THAT(report["not_proved"].get<std::string>(), HasSubstr("the process isn't pinned"));
}

TEST_F(ProvedByCommand, IsNoneIfAFunctionOfTheMathematicsIsReplaced) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "AddressSanitizer's library has to be the first one";
#endif
  expect_simulated(check("LD_PRELOAD=" OTHER_SINE), "the library libother_sine.so");
}

/// The path of a library of this process.
std::string loaded(const std::string& name) {
  std::pair<std::string, std::string> found{name, ""};
  const auto take = [](dl_phdr_info* library, std::size_t, void* into) {
    auto& wanted = *static_cast<std::pair<std::string, std::string>*>(into);
    if (std::string(library->dlpi_name).find("/" + wanted.first) != std::string::npos)
      wanted.second = library->dlpi_name;
    return 0;
  };
  dl_iterate_phdr(take, &found);
  return found.second;
}

void ProvedByCommand::expect_simulated_with_other(const std::string& library, const std::string& text,
                                                  const fs::path& below) const {
  const fs::path original = loaded(library);
  std::string bytes = test::read_file(original);
  const std::size_t at = bytes.find(text);
  ASSERT_NE(at, std::string::npos) << text << " isn't in " << original;
  bytes[at] ^= 1;
  fs::create_directories(folder() / below);
  write((below / original.filename()).string(), bytes);
  expect_simulated(check("LD_LIBRARY_PATH=" + folder().string()), "the library " + original.filename().string());
}

TEST_F(ProvedByCommand, IsNoneWithAChangedEngine) { expect_simulated_with_other("libode.so", "ODE"); }

TEST_F(ProvedByCommand, IsNoneWithAChangedLibraryOfRehearse) {
  expect_simulated_with_other("librehearse_simulation.so", "is not positive definite");
}

TEST_F(ProvedByCommand, IsNoneWithAnotherLibraryThatIsNamedLikeOneOfRehearse) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "AddressSanitizer's library has to be the first one";
#endif
  const fs::path copy = folder() / "librehearse_sine.so";
  fs::copy_file(OTHER_SINE, copy);
  expect_simulated(check("LD_PRELOAD=" + copy.string()), "the library librehearse_sine.so");
}

TEST_F(ProvedWithACamera, IsNoneWithAChangedRenderer) {
  ASSERT_NE(dlopen(Renderer::library, RTLD_NOW), nullptr) << dlerror();  // that drawing loads
  expect_simulated_with_other(Renderer::library, "Mesa: User error");
}

TEST_F(ProvedWithAMesh, IsNoneWithAChangedAssimp) {
  expect_simulated_with_other("libassimp.so", "Open Asset Import Library (Assimp)");
}

TEST_F(ProvedWithAMesh, IsNoneWithAChangedReader) {
  const fs::path harness = loaded("librehearse_harness.so");  // which loads the reader that is beside itself
  fs::copy_file(harness, folder() / harness.filename());
  // it finds these beside itself, too
  const fs::path cnoid = loaded("librehearse_cnoid.so");
  fs::create_symlink(cnoid, folder() / cnoid.filename());
  fs::create_directories(folder() / "rehearse");
  fs::create_directory_symlink(harness.parent_path() / "rehearse/controllers", folder() / "rehearse/controllers");
  expect_simulated_with_other("librehearse_assimp.so", "a node of it refers to a mesh", "rehearse");
}

TEST_F(ProvedByCommand, WithoutAMeshDependsOnNoReader) {
  const auto plant = describe_plant(*Scenario::load(scenario()));
  ASSERT_TRUE(plant.ok()) << to_string(plant.errors());
  EXPECT_EQ(plant->count("the library librehearse_harness.so.0.1"), 1U);
  for (const auto& [fact, value] : *plant) EXPECT_THAT(fact, Not(HasSubstr("assimp")));
}

TEST_F(ProvedByCommand, IsNoneAfterAChangeThatTheCheckTellsInWords) {
  const test::Outcome outcome = rehearse({"check", scenario().string(), "--golden", "golden.mcap"}, "MESA_NO_DITHER=1");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(
      outcome.out,
      HasSubstr("\n  simulated, not proved: the renderer's environment changed since its golden was simulated\n"));
}

TEST_F(ProvedByCommand, IsNoneWithOtherSettingsOfTheRenderer) {
  expect_simulated(check("MESA_NO_DITHER=1"), "the renderer's environment");
}

TEST_F(ProvedByCommand, IsNotSoughtIfTheUserSaysSo) {
  for (const nlohmann::json& report : {check("REHEARSE_PROOF=off"), check("", {"--simulate"})}) {
    EXPECT_EQ(report["proved"], false);
    EXPECT_EQ(report["not_proved"], nullptr);
    EXPECT_EQ(report["simulated_from"], 0);
  }
  EXPECT_EQ(check("REHEARSE_PROOF=sample:100")["proved"], true);
  const test::Outcome outcome =
      rehearse({"check", scenario().string(), "--golden", "golden.mcap"}, "REHEARSE_PROOF=no");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("REHEARSE_PROOF is 'no'"));
}

}  // namespace
}  // namespace rehearse
