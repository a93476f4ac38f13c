// What is proved is what a simulation gives, for random changes of everything on which a run may depend: the scenario,
// models, files, variables of the environment, libraries and options of controllers, and their calls of the API.
//
// Each mutant makes one to three changes of a scenario that has a golden and a certificate, and is checked twice: with
// proofs, and without. A proof is wrong if the simulation isn't equal to the golden bit for bit.
// REHEARSE_PROOF_MUTANTS=20000 REHEARSE_PROOF_SEED=3 build/bin/proof_fuzz_test makes more and other mutants.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/check.h>
#include <rehearse/session.h>

#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/check/own_run.h"
#include "core/guard/own_process.h"
#include "small_traces.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr int ticks = 60;

constexpr const char* rig_urdf = R"(<?xml version="1.0"?>
<robot name="Rig">
  <link name="world"/>
  <joint name="SHOULDER" type="continuous">
    <parent link="world"/><child link="ARM"/><origin xyz="0 0 1"/><axis xyz="0 1 0"/>
  </joint>
  <link name="ARM">
    <inertial><origin xyz="0 0 -0.2"/><mass value="1"/><inertia ixx="0.5" ixy="0" ixz="0" iyy="0.5" iyz="0" izz="0.5"/></inertial>
    <visual><geometry><box size="0.4 0.1 0.1"/></geometry></visual>
    <collision><geometry><mesh filename="hull.stl"/></geometry></collision>
  </link>
  <joint name="RAIL" type="prismatic">
    <parent link="world"/><child link="SLED"/><origin xyz="0 2 1"/><axis xyz="1 0 0"/>
    <limit lower="-100" upper="100" effort="1000" velocity="1000"/>
  </joint>
  <link name="SLED">
    <inertial><mass value="2"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
  </link>
  <gazebo reference="ARM"><sensor name="Gyro" type="gyroscope"/></gazebo>
  <gazebo reference="SLED">
    <light name="Lamp" type="point"><intensity>0.5</intensity></light>
    <sensor name="Camera" type="camera">
      <pose>0 0 0 0 0 -1.5707963267948966</pose>
      <update_rate>100</update_rate>
      <camera><image><width>16</width><height>12</height></image></camera>
    </sensor>
  </gazebo>
</robot>
)";

constexpr const char* hull_stl = R"(solid hull
facet normal 0 0 -1
outer loop
vertex 0 0 0
vertex 0 0.1 0
vertex 0.1 0 0
endloop
endfacet
facet normal 0 -1 0
outer loop
vertex 0 0 0
vertex 0.1 0 0
vertex 0 0 0.1
endloop
endfacet
facet normal -1 0 0
outer loop
vertex 0 0 0
vertex 0 0 0.1
vertex 0 0.1 0
endloop
endfacet
facet normal 1 1 1
outer loop
vertex 0.1 0 0
vertex 0 0.1 0
vertex 0 0 0.1
endloop
endfacet
endsolid hull
)";

constexpr const char* scenario_yaml = R"(rehearse: 1
name: fuzz
duration: 0.06
seed: 7
gravity: [0, 0, -9.8]
solver: {friction: 0.9, iterations: 40}
bodies:
  - name: Floor
    box: {size: [10, 10, 0.2]}
    fixed: true
    position: [0, 0, -0.1]
  - name: Ball
    sphere: {radius: 0.1}
    mass: 0.5
    position: [1, 0, 0.101]
  - name: Rig
    model: rig.urdf
    joints: {SHOULDER: 20 deg}
    controllers: [{name: Caller, library: Caller, options: "CALLS"}]
noise:
  - {sensor: Rig/Gyro, angular_velocity: {stddev: 0.001}}
pushes:
  - {body: Ball, from: 0.02, until: 0.03, force: [5, 0, 0]}
tolerances:
  - {channel: "*", atol: 1e-9}
)";

/// The files and variables of a scenario, to which changes are applied.
class Workplace {
 public:
  Workplace(fs::path folder, bool with_camera) : folder_(std::move(folder)), with_camera_(with_camera) { restore(); }

  void restore() {
    files_ = {{"scenario.yaml", scenario_yaml}, {"rig.urdf", rig_urdf}, {"hull.stl", hull_stl}};
    if (!with_camera_) files_["scenario.yaml"] += "cameras: []\n";  // else all are on
    files_["share/gain.txt"] = "2.0\n";
    files_["other_share/gain.txt"] = "2.5\n";
    linked_ = STRENGTH_1;
    variables_ = {{"REHEARSE_CHOREONOID_SHARE", (folder_ / "share").string()}, {"CALLER_GAIN", "3"}};
    calls_.clear();
  }
  void replace(const std::string& file, const std::string& from, const std::string& to) {
    const auto found = files_.find(file);
    if (found == files_.end()) return;  // an earlier change has removed it
    std::string& text = found->second;
    if (const std::size_t at = text.find(from); at != std::string::npos) text.replace(at, from.size(), to);
  }
  void remove(const std::string& file) { files_.erase(file); }
  /// The library that CallerLinked links.
  void link(const char* library) { linked_ = library; }
  void set(const std::string& variable, const std::string& value) { variables_[variable] = value; }
  void call(const std::string& member, int tick) { calls_.push_back(fmt::format("{}@{}", member, tick)); }
  fs::path path(const std::string& name) const { return folder_ / name; }

  /// Writes the files and sets the variables.
  void set_up() const {
    for (const char* file : {"scenario.yaml", "rig.urdf", "hull.stl", "share/gain.txt", "other_share/gain.txt"}) {
      const auto found = files_.find(file);
      fs::create_directories(path(file).parent_path());
      fs::remove(path(file));
      if (found == files_.end()) continue;
      std::string text = found->second;
      if (const std::size_t at = text.find("CALLS"); at != std::string::npos)
        text.replace(at, 5, fmt::format("{}", fmt::join(calls_, " ")));
      std::ofstream(path(file), std::ios::binary) << text;
    }
    fs::create_directories(path("lib"));
    for (const auto& [from, to] :
         {std::pair(VERDICT_CONTROLLERS "/CallerLinked.so", "lib/CallerLinked.so"), {linked_, "lib/libstrength.so"}}) {
      fs::remove(path(to));
      fs::copy_file(from, path(to));
    }
    for (const char* variable : {"REHEARSE_CHOREONOID_SHARE", "CALLER_GAIN", "CALLER_NOTE", "TZ", "MESA_NO_DITHER"}) {
      const auto found = variables_.find(variable);
      found == variables_.end() ? unsetenv(variable) : setenv(variable, found->second.c_str(), 1);
    }
  }

 private:
  fs::path folder_;
  bool with_camera_;
  std::map<std::string, std::string> files_, variables_;
  std::vector<std::string> calls_;
  const char* linked_ = STRENGTH_1;
};

struct Change {
  std::string name;
  std::function<void(Workplace&)> make;
};

Change edit(const char* file, const char* from, const char* to) {
  return {fmt::format("{}: {} -> {}", file, from, to), [=](Workplace& at) { at.replace(file, from, to); }};
}

/// Changes of files and variables.
std::vector<Change> changes_of_the_surroundings() {
  constexpr const char* yaml = "scenario.yaml";
  std::vector<Change> all{
      edit(yaml, "gravity: [0, 0, -9.8]", "gravity: [0, 0, -9.81]"),
      edit(yaml, "gravity: [0, 0, -9.8]", "gravity: [0.0, 0, -9.8]"),
      edit(yaml, "duration: 0.06", "duration: 0.05"),
      edit(yaml, "duration: 0.06", "duration: 0.06\ntime_step: 0.0005"),
      edit(yaml, "duration: 0.06", "duration: 0.060"),
      edit(yaml, "seed: 7", "seed: 8"),
      edit(yaml, "name: fuzz", "name: another"),
      edit(yaml, "friction: 0.9", "friction: 0.91"),
      edit(yaml, "iterations: 40", "iterations: 41"),
      edit(yaml, "iterations: 40", "iterations: 40, method: exact"),
      edit(yaml, "mass: 0.5", "mass: 0.5000001"),
      edit(yaml, "position: [1, 0, 0.101]", "position: [1, 0, 0.1010001]"),
      edit(yaml, "SHOULDER: 20 deg", "SHOULDER: 20.0001 deg"),
      edit(yaml, "stddev: 0.001", "stddev: 0.0011"),
      edit(yaml, "force: [5, 0, 0]", "force: [5.01, 0, 0]"),
      edit(yaml, "until: 0.03", "until: 0.0301"),
      edit(yaml, "until: 0.03", "until: 0.031"),
      edit(yaml, "atol: 1e-9", "atol: 1"),
      edit(yaml, "name: fuzz", "name: fuzz\nhorizon: 0.03"),
      edit(yaml, "name: fuzz", "name: fuzz\nexpect: [{channel: Ball/Ball/position/z, above: 0.05}]"),
      edit(yaml, "name: fuzz", "name: fuzz\nexpect: [{channel: Ball/Ball/position/z, above: 0.5}]"),
      edit(yaml, "name: fuzz", "name: fuzz\noptions: dq_target@3"),
      edit(yaml, "options: \"CALLS\"", "options: \"CALLS\", delay: false"),
      edit(yaml, "options: \"CALLS\"", "options: \"CALLS\", optional: true"),
      edit(yaml, "library: Caller,", "library: CallerAgain,"),
      edit(yaml, "library: Caller,", "library: CallerWithOtherGain,"),
      edit(yaml, "library: Caller,", "library: lib/CallerLinked.so,"),
      {"another linked library", [](Workplace& at) { at.link(STRENGTH_2); }},
      edit(yaml, "name: Caller,", "name: Caller2,"),
      edit(yaml, "  - name: Ball", "  - name: Ball2"),
      edit(yaml, "noise:", "# a comment\nnoise:"),
      edit("rig.urdf", "<mass value=\"1\"/>", "<mass value=\"1.0001\"/>"),
      edit("rig.urdf", "<mass value=\"1\"/>", "<mass value=\"1.0\"/>"),
      edit("rig.urdf", "0.4 0.1 0.1", "0.4 0.1 0.2"),
      edit("rig.urdf", "upper=\"100\"", "upper=\"0.001\""),
      edit("rig.urdf", "<intensity>0.5", "<intensity>0.6"),
      edit("rig.urdf", "<update_rate>100", "<update_rate>50"),
      edit("hull.stl", "vertex 0.1 0 0", "vertex 0.11 0 0"),
      edit("share/gain.txt", "2.0", "2.1"),
      edit("share/gain.txt", "2.0", "2.00"),
      {"share/gain.txt is gone", [](Workplace& at) { at.remove("share/gain.txt"); }},
      {"another share", [](Workplace& at) { at.set("REHEARSE_CHOREONOID_SHARE", at.path("other_share").string()); }},
      {"no share", [](Workplace& at) { at.set("REHEARSE_CHOREONOID_SHARE", at.path("nowhere").string()); }},
      {"CALLER_GAIN=3.1", [](Workplace& at) { at.set("CALLER_GAIN", "3.1"); }},
      {"CALLER_GAIN=3.0", [](Workplace& at) { at.set("CALLER_GAIN", "3.0"); }},
      {"TZ=Asia/Tokyo", [](Workplace& at) { at.set("TZ", "Asia/Tokyo"); }},
      {"MESA_NO_DITHER=1", [](Workplace& at) { at.set("MESA_NO_DITHER", "1"); }},
  };
  return all;
}

constexpr const char* members[] = {"no_delay",
                                   "delay",
                                   "enable_input",
                                   "enable_device",
                                   "enable_output",
                                   "mode",
                                   "no_mode",
                                   "u",
                                   "same_u",
                                   "negative_zero",
                                   "dq_target",
                                   "nan",
                                   "q_target",
                                   "own_q",
                                   "own_q_of_input",
                                   "root",
                                   "force",
                                   "kinematics",
                                   "lamp_off",
                                   "lamp_off_unsaid",
                                   "lamp_dimmed",
                                   "lamp_said",
                                   "camera_off",
                                   "camera_off_unsaid",
                                   "camera_rate",
                                   "gyro_said",
                                   "info",
                                   "line",
                                   "half_line",
                                   "variable",
                                   "done",
                                   "throw",
                                   "folder",
                                   "environment",
                                   "locale",
                                   "rounding",
                                   "random",
                                   "unseeded",
                                   "runs"};

std::vector<Change> all_changes() {
  std::vector<Change> all = changes_of_the_surroundings();
  for (const std::string member : members)
    for (const int tick : {0, ticks / 2, ticks - 1})
      all.push_back({fmt::format("{}@{}", member, tick), [=](Workplace& at) { at.call(member, tick); }});
  return all;
}

long number_of(const char* variable, long usual) {
  const char* text = std::getenv(variable);
  return text ? std::atol(text) : usual;
}

const Simulation simulation{record, run_plant, describe_plant, record_from};

/// A scenario with a golden, which a check has simulated.
class Subject {
 public:
  Subject(fs::path folder, bool with_camera, const std::vector<const Change*>& usual)
      : workplace_(std::move(folder), with_camera), usual_(usual) {
    reset();
    workplace_.set_up();
    const auto scenario = Scenario::load(workplace_.path("scenario.yaml"));
    EXPECT_TRUE(scenario.ok()) << to_string(scenario.errors());
    const auto made = own_run(
        [&]() -> Result<RunSummary> { return record(*scenario, workplace_.path("golden.mcap"), RecordOptions()); });
    EXPECT_TRUE(made.ok()) << to_string(made.errors());
    const auto first = check(true);
    EXPECT_TRUE(first.ok()) << to_string(first.errors());
    EXPECT_EQ(first->closed, LevelState::equal) << first->verdict.text();
  }

  /// Makes the changes, and returns the reason why the two checks contradict each other; empty: they agree.
  std::string try_changes(const std::vector<const Change*>& changes) {
    reset();
    for (const Change* change : changes) change->make(workplace_);
    workplace_.set_up();
    const auto proved = check(true);
    workplace_.set_up();  // a controller may have changed a variable
    const auto simulated = check(false);
    if (proved.ok() != simulated.ok()) return "one of the checks fails";
    if (!proved) return "";
    proofs += proved->proved;
    differences += !simulated->within();
    if (proved->proved && !simulated->equal()) return "proved, but simulated: " + simulated->verdict.text();
    if (proved->within() != simulated->within())
      return fmt::format("with proofs: {}\nsimulated: {}", proved->verdict.text(), simulated->verdict.text());
    return "";
  }

  int proofs = 0, differences = 0;

 private:
  void reset() {
    workplace_.restore();
    for (const Change* change : usual_) change->make(workplace_);
  }
  Result<CheckReport> check(bool with_proofs) const {
    const auto scenario = Scenario::load(workplace_.path("scenario.yaml"));
    if (!scenario) return scenario.errors();
    CheckOptions options;
    if (with_proofs) options.certificates = workplace_.path("proofs");
    return check_scenario(*scenario, workplace_.path("golden.mcap"), workplace_.path("actual.mcap"), options,
                          simulation);
  }

  Workplace workplace_;
  std::vector<const Change*> usual_;
};

TEST(ProofFuzz, WhatIsProvedIsWhatASimulationGives) {
  begin_own_processes();  // as the verbs do: state of a process must not tell its runs apart
  setenv("REHEARSE_CONTROLLER_PATH", VERDICT_CONTROLLERS, 1);
  const std::vector<Change> changes = all_changes();
  std::mt19937 random(static_cast<unsigned>(number_of("REHEARSE_PROOF_SEED", 1)));
  const auto draw = [&](std::size_t below) { return std::uniform_int_distribution<std::size_t>(0, below - 1)(random); };
  const auto some = [&](std::size_t least, std::size_t most) {
    std::vector<const Change*> chosen;
    for (std::size_t left = least + draw(most - least + 1); left > 0; --left)
      chosen.push_back(&changes[draw(changes.size())]);
    return chosen;
  };
  const auto call = [&](const std::string& name) {
    for (const Change& change : changes)
      if (change.name == name) return &change;
    ADD_FAILURE() << name << " is no change";
    return &changes[0];
  };
  const testing::TemporaryFolder folder;
  std::vector<std::unique_ptr<Subject>> subjects;
  subjects.push_back(std::make_unique<Subject>(folder / "plain", false, std::vector<const Change*>{}));
  subjects.push_back(std::make_unique<Subject>(folder / "seen", true, std::vector<const Change*>{}));
  subjects.push_back(
      std::make_unique<Subject>(folder / "calls", false, std::vector{call("no_delay@30"), call("lamp_off@0")}));
  subjects.push_back(
      std::make_unique<Subject>(folder / "switched", true, std::vector{call("camera_off@30"), call("line@59")}));
  subjects.push_back(
      std::make_unique<Subject>(folder / "state", false, std::vector{call("unseeded@30"), call("runs@59")}));
  subjects.push_back(std::make_unique<Subject>(
      folder / "linked", false, std::vector{call("scenario.yaml: library: Caller, -> library: lib/CallerLinked.so,")}));

  constexpr long usual = 160;  // each change alone; the nightly run makes a thousand, of which most are some together
  const long mutants = number_of("REHEARSE_PROOF_MUTANTS", usual);
  for (long i = 0; i < mutants; ++i) {
    // at first each change alone
    const bool alone = i < static_cast<long>(changes.size());
    const auto chosen = alone ? std::vector{&changes[static_cast<std::size_t>(i)]} : some(1, 3);
    constexpr std::size_t with_camera[] = {1, 3}, without[] = {0, 2, 4, 5};
    Subject& subject = *subjects[draw(10) == 0 ? with_camera[draw(2)] : without[draw(4)]];  // cameras take time
    std::vector<std::string> names;
    for (const Change* change : chosen) names.push_back(change->name);
    ASSERT_EQ(subject.try_changes(chosen), "") << fmt::format("mutant {}: {}", i, fmt::join(names, "; "));
  }
  long proofs = 0, differences = 0;
  for (const auto& subject : subjects) {
    proofs += subject->proofs;
    differences += subject->differences;
  }
  EXPECT_GT(proofs, mutants / 10) << "most changes have no effect on the golden's bits";
  EXPECT_GT(differences, mutants / 10);
  RecordProperty("proofs", std::to_string(proofs));
  fmt::print("{} mutants: {} proved, {} differ\n", mutants, proofs, differences);
}

}  // namespace
}  // namespace rehearse
