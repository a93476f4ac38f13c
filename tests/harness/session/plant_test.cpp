// The world under recorded commands: cases in which its state can't be restored, and commands that can't be applied.
// Every run of these tests (runs.h) checks that the plant repeats, whatever the controllers do.
#include <rehearse/session.h>

#include "core/simulation/checkpoint_trial.h"
#include "mutilate.h"
#include "runs.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class PlantRun : public RunTest {
 protected:
  /// 0.25 s of a sled that oscillates: checkpoints at ticks 0, 100 and 200.
  static std::string swinging(const std::string& more = "cameras: none\n") {
    return rig("{name: Pd, library: HingePd}", more, "0.25");
  }

  /// The trace of a recording under its commands.
  Trace moved(const Scenario& scenario, const Trace& recording, const PlantOptions& options = {}) {
    auto run = run_plant(scenario, recording, path("moved.mcap"), options);
    EXPECT_TRUE(run.ok()) << to_string(run.errors());
    if (!run) return {};
    run_ = *run;
    return *Trace::load(path("moved.mcap"));
  }

  /// The recording, changed message by message and in its outcome.
  Trace changed(const testing::Mutilation& change, const mcap::StringMap& outcome = {}) {
    const auto done = testing::mutilate(path("run.mcap"), change, outcome);
    EXPECT_TRUE(done.ok()) << to_string(done.errors());
    return *Trace::load(path("run.mcap"));
  }

  static std::string problem(const Result<PlantSummary>& run) { return run ? "none" : to_string(run.errors()); }

  PlantSummary run_;
};

TEST_F(PlantRun, IsSetBackAtEachCheckpoint) {
  const Trace recording = record_run(swinging());
  const Trace again = moved(load(swinging()), recording);
  EXPECT_EQ(run_.ticks, 250);
  EXPECT_EQ(run_.restored, 3);
  EXPECT_EQ(again.integers("state_hash"), recording.integers("state_hash"));
}

TEST_F(PlantRun, ForgetsADifferenceAtTheNextCheckpoint) {
  const Trace recording = record_run(swinging());
  const std::string pushed =
      swinging("cameras: none\npushes: [{body: Rig, link: SLED, force: [50, 0, 0], from: 0.02, until: 0.03}]\n");
  const std::vector<std::uint64_t> expected = recording.integers("state_hash");
  const std::vector<std::uint64_t> states = moved(load(pushed), recording).integers("state_hash");
  EXPECT_EQ(states[20], expected[20]);
  EXPECT_NE(states[21], expected[21]);
  EXPECT_NE(states[100], expected[100]) << "what is recorded at a checkpoint is what came of the ticks before it";
  EXPECT_TRUE(std::equal(states.begin() + 101, states.end(), expected.begin() + 101));
}

TEST_F(PlantRun, KeepsADifferenceIfItIsNotSetBack) {
  const Trace recording = record_run(swinging());
  const std::string pushed =
      swinging("cameras: none\npushes: [{body: Rig, link: SLED, force: [50, 0, 0], from: 0.02, until: 0.03}]\n");
  PlantOptions options;
  options.resync = false;
  EXPECT_NE(moved(load(pushed), recording, options).integers("state_hash").back(),
            recording.integers("state_hash").back());
  EXPECT_EQ(run_.restored, 0);
  EXPECT_EQ(run_.from_the_start, "") << "nobody wanted it to be set back";
}

TEST_F(PlantRun, EndsWhereItIsToldTo) {
  const Trace recording = record_run(swinging());
  PlantOptions options;
  options.until = 120;
  EXPECT_EQ(moved(load(swinging()), recording, options).integers("tick").back(), 120u);
}

TEST_F(PlantRun, WithoutCheckpointsRunsFromTheStartAndSaysSo) {
  record_run(swinging());
  const Trace recording = changed([](const mcap::Message& message) {
    return message.channel->topic == "/checkpoint" ? std::nullopt : testing::untouched(message);
  });
  EXPECT_EQ(moved(load(swinging()), recording).integers("state_hash"), recording.integers("state_hash"));
  EXPECT_EQ(run_.restored, 0);
  EXPECT_EQ(run_.from_the_start, "the recording has no checkpoints");
}

TEST_F(PlantRun, DoesNotTrustCheckpointsThatTheRecordingCallsInexact) {
  record_run(swinging());
  const Trace recording = changed(testing::untouched, {{"checkpoints", "inexact: at tick 100"}});
  EXPECT_EQ(moved(load(swinging()), recording).integers("state_hash"), recording.integers("state_hash"));
  EXPECT_EQ(run_.restored, 0);
  EXPECT_EQ(run_.from_the_start, "the recording says that its checkpoints are inexact: at tick 100");
}

/// Replaces all occurrences of a text by a different text of the same length.
testing::Mutilation replaced(const std::string& from, const std::string& to) {
  return [=](const mcap::Message& message) {
    auto bytes = *testing::untouched(message);
    const auto* letters = reinterpret_cast<const char*>(from.data());
    const auto found = std::search(bytes.begin(), bytes.end(), letters, letters + from.size(),
                                   [](std::byte byte, char letter) { return static_cast<char>(byte) == letter; });
    if (found != bytes.end()) std::memcpy(&*found, to.data(), to.size());
    return std::optional(bytes);
  };
}

TEST_F(PlantRun, OfCheckpointsInAnotherFormRunsFromTheStart) {
  record_run(swinging());
  const Trace recording = changed(replaced("rehearse-ode-state-1", "rehearse-ode-state-9"));
  EXPECT_EQ(moved(load(swinging()), recording).integers("state_hash"), recording.integers("state_hash"));
  EXPECT_THAT(run_.from_the_start, StartsWith("its checkpoints are in the form 'rehearse-ode-state-9'"));
}

TEST_F(PlantRun, EndsWhereTheCheckpointsHaveNoStateOfABody) {
  const Trace recording = record_run(swinging());
  std::string larger = swinging();
  larger.insert(larger.find("bodies:\n") + 8,
                "  - {name: Ball, sphere: {radius: 0.1}, mass: 1, position: [0, 0, 5]}\n");
  const auto refused = run_plant(load(larger), recording, folder_ / "plant.mcap");
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.errors()[0].message,
              HasSubstr("the checkpoint of tick 0 doesn't fit: body 'Ball' isn't in the state"));
}

TEST_F(PlantRun, NamesCommandsToWhatTheScenarioHasNot) {
  const Trace recording = record_run(swinging());
  std::string other = swinging();
  other.replace(other.find("name: Pd"), 8, "name: Pq");
  EXPECT_EQ(problem(run_plant(load(other), recording, path("moved.mcap"))),
            path("run.mcap").string() +
                ": error: the recording has commands on /Rig/Pd/output/joints, but run has no such controller\n");
  std::string urdf = rig_urdf;
  urdf.replace(urdf.find("\"SHOULDER\""), 10, "\"ELBOW\"");
  write("rig.urdf", urdf);
  EXPECT_THAT(problem(run_plant(load(swinging()), recording, path("moved.mcap"))),
              HasSubstr("the recording commands joint 'SHOULDER', which 'Rig' lacks"));
}

TEST_F(PlantRun, BeginsAtCheckpointsOnly) {
  const Trace recording = record_run(swinging());
  PlantOptions options;
  options.from = 150;
  EXPECT_EQ(problem(run_plant(load(swinging()), recording, path("moved.mcap"), options)),
            "error: the recording has no checkpoint at tick 150\n");
  options.from = 200;
  EXPECT_EQ(moved(load(swinging()), recording, options).integers("tick").front(), 200u);
}

TEST_F(PlantRun, NudgedDiffersByLastBitsOnly) {
  const Trace recording = record_run(swinging());
  PlantOptions options;
  options.nudge = 1;
  const Trace nudged = moved(load(swinging()), recording, options);
  EXPECT_NE(nudged.integers("state_hash"), recording.integers("state_hash"));
  CompareOptions what;
  what.stages = {Stage::physics};
  const Comparison comparison = compare(recording, nudged, {}, what);
  ASSERT_TRUE(comparison.worst);
  EXPECT_LT(comparison.worst->difference, 1e-11);
}

TEST_F(PlantRun, OfATraceThatIsNoRecordingFails) {
  record_run(swinging());
  const Trace recording = changed([](const mcap::Message& message) {
    return message.channel->topic == "/tick" ? std::nullopt : testing::untouched(message);
  });
  EXPECT_THAT(problem(run_plant(load(swinging()), recording, path("moved.mcap"))), HasSubstr("it has no ticks"));
}

TEST_F(PlantRun, OfACheckpointThatIsCutFailsWithItsPlace) {
  record_run(swinging());
  const Trace recording = changed([](const mcap::Message& message) {
    auto bytes = *testing::untouched(message);
    if (message.channel->topic == "/checkpoint") bytes.resize(bytes.size() / 2);
    return std::optional(bytes);
  });
  EXPECT_THAT(problem(run_plant(load(swinging()), recording, path("moved.mcap"))),
              HasSubstr("a message on /checkpoint at 0 ns is not of its type"));
}

TEST_F(PlantRun, TellsThatTheSimulationExploded) {
  record_run(swinging());
  const Trace recording = changed([](const mcap::Message& message) {
    auto bytes = *testing::untouched(message);
    const double wild = 1e308;  // [N·m], the last number of the message
    if (message.channel->topic == "/Rig/Pd/output/joints" && message.log_time == 20000000)
      std::memcpy(bytes.data() + bytes.size() - sizeof wild, &wild, sizeof wild);
    return std::optional(bytes);
  });
  moved(load(swinging()), recording);
  ASSERT_TRUE(run_.failure);
  EXPECT_THAT(run_.failure->message, HasSubstr("the simulation exploded in the step after tick 21"));
}

// The trial of checkpoints while recording.

TEST_F(PlantRun, SaysInTheRecordingThatCheckpointsAreExact) {
  const Trace recording = record_run(swinging());
  EXPECT_EQ(recording.find_metadata("rehearse.outcome")->at("checkpoints"), "exact");
}

TEST_F(PlantRun, TrialNoticesAStateThatIsNotTheRuns) {
  const Scenario scenario = load(rig(""));
  const auto make = [&] {
    WorldBody rig;
    rig.name = "Rig";
    rig.model = scenario.bodies[0].model;
    rig.joints = {0.1, 0.25};
    return *World::create({scenario.time_step, scenario.gravity, 0, scenario.solver}, {rig});
  };
  const std::unique_ptr<World> run = make();
  Command still;
  still.bodies.resize(1);
  still.bodies[0].joints.resize(2);
  still.bodies[0].external.resize(scenario.bodies[0].model->links.size());
  still.bodies[0].devices.resize(scenario.bodies[0].model->devices.size());
  for (const bool other : {false, true}) {
    CheckpointTrial trial(scenario);
    const std::vector<std::byte> state = run->save();
    if (other) run->nudge(1);  // simulates a fault of restoring
    trial.begin(1, state);
    trial.step(still);
    run->actuate(still);
    ASSERT_TRUE(run->step());
    trial.compare(*run);
    EXPECT_THAT(trial.verdict(), other ? HasSubstr("inexact: restored at tick 1") : HasSubstr("exact"));
    EXPECT_EQ(trial.verdict() == CheckpointTrial::exact, !other);
  }
}

}  // namespace
}  // namespace rehearse
