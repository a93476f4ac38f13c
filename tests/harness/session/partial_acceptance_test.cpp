// Parts of runs are accepted into a golden, or refused: the decision is made by executing them again.
#include <rehearse/golden.h>
#include <rehearse/session.h>

#include "runs.h"
#include "support/files.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class PartialAcceptance : public RunTest {
 protected:
  PartialAcceptance() { again_.run_plant = run_plant; }

  /// The wheel under a controller and a camera that nobody reads, before a wall of that red; `more` are further lines.
  static std::string scene(const std::string& library, const std::string& red, const std::string& more = "",
                           const std::string& duration = "0.1") {
    return "rehearse: 1\nduration: " + duration + "\nbodies:\n  - name: Rig\n    model: rig.urdf\n" +
           "    joints: {SHOULDER: 0.3}\n    controllers: [{name: C, library: " + library + "}]\n" +
           "  - name: Wall\n    box: {size: [9, 0.5, 9], color: [" + red + ", 0.2, 0.2]}\n    fixed: true\n" +
           "    position: [0, -4, 0]\n" + more;
  }

  /// The result of accepting a part of the run; the error's message and hint if it is refused.
  std::string decided(const std::vector<std::string>& channels, double from = 0.0,
                      std::optional<double> until = std::nullopt) {
    const auto golden = Trace::load(path("golden.mcap")), run = Trace::load(path("run.mcap"));
    EXPECT_TRUE(golden && run);
    const auto made = make_partial(*golden, *run, {channels, from, until}, path("candidate.mcap"), again_);
    EXPECT_EQ(fs::exists(path("candidate.mcap")), made && *made == path("candidate.mcap"));
    EXPECT_FALSE(fs::exists(path("candidate.mcap.plant")));
    if (!made) return made.errors()[0].message + " (" + made.errors()[0].hint + ")";
    return made->filename();
  }

  Reexecution again_;
};

TEST_F(PartialAcceptance, OfACameraThatNobodyReadsIsTheWholeRun) {
  record_run(scene("HingePd", "0.2"), "golden.mcap");
  record_run(scene("HingePd", "0.9"));
  EXPECT_EQ(decided({"/Rig/Camera/*"}), "run.mcap");
  EXPECT_EQ(decided({"Rig/Camera/image"}), "run.mcap");
}

TEST_F(PartialAcceptance, OfASpanOutsideOfWhichNothingMovedIsTheWholeRun) {
  record_run(scene("HingePd", "0.2"), "golden.mcap");
  record_run(scene("HingePdChanged", "0.2"));
  EXPECT_EQ(decided({}, 0.07), "run.mcap");
  EXPECT_THAT(decided({}, 0.0, 0.071), HasSubstr("no run can produce this golden: "));
}

TEST_F(PartialAcceptance, OfCommandsWithoutWhatTheyDoIsRefused) {
  record_run(scene("HingePd", "0.2"), "golden.mcap");
  record_run(scene("HingePdChanged", "0.2"));
  const std::string refusal = decided({"Rig/C/output/SHOULDER/u"});
  EXPECT_THAT(refusal, HasSubstr("no run can produce this golden: with its commands, the world moves differently, "
                                 "first at tick 72 (0.07"));
  EXPECT_THAT(refusal, HasSubstr("): /Rig/joints SHOULDER/"));
  EXPECT_THAT(refusal, HasSubstr("would have to be accepted as well: /Rig/joints, "));
}

TEST_F(PartialAcceptance, OfAStateWithoutTheCommandsThatMadeItIsRefused) {
  record_run(scene("HingePd", "0.2"), "golden.mcap");
  record_run(scene("HingePdChanged", "0.2"));
  EXPECT_THAT(decided({"Rig/SHOULDER/*", "/Rig/*/imu", "/Rig/*/wrench"}),
              AllOf(HasSubstr("no run can produce this golden"), HasSubstr("/Rig/C/output/joints")));
}

TEST_F(PartialAcceptance, OfACameraIsRefusedIfTheControllerCommandsSomethingElseToo) {
  record_run(scene("HingePd", "0.2"), "golden.mcap");
  record_run(scene("HingePdChanged", "0.9"));
  EXPECT_THAT(decided({"/Rig/Camera/*"}),
              AllOf(HasSubstr("with its inputs, the controllers give other commands, first at tick 70 (0.07 s): "
                              "/Rig/C/output/joints SHOULDER/u"),
                    HasSubstr("would have to be accepted as well: /Rig/C/output/joints")));
}

TEST_F(PartialAcceptance, IsMadeIfWhatIsKeptFollowsWhenItIsExecutedAgain) {
  record_run(scene("HingePd", "0.2"), "golden.mcap");
  // a change of the controller that was taken back since, and a change of colour that wasn't
  RecordOptions changed;
  changed.libraries["C"] = "HingePdChanged";
  ASSERT_TRUE(record(load(scene("HingePd", "0.9")), path("run.mcap"), changed));
  ASSERT_EQ(decided({"/Rig/Camera/image"}), "candidate.mcap");

  record_run(scene("HingePd", "0.9"), "would_be.mcap");
  const auto candidate = Trace::load(path("candidate.mcap")), would_be = Trace::load(path("would_be.mcap"));
  ASSERT_TRUE(candidate && would_be);
  const Comparison comparison = compare(*candidate, *would_be, {});
  EXPECT_TRUE(comparison.equal) << verdict(comparison);
  EXPECT_TRUE(comparison.remarks.empty()) << comparison.remarks[0];  // its controller is the one that it is true of
  EXPECT_FALSE(compare(*Trace::load(path("golden.mcap")), *candidate, {}).equal);
  EXPECT_FALSE(compare(*Trace::load(path("run.mcap")), *candidate, {}).equal);
}

TEST_F(PartialAcceptance, WithoutPhysicsShowsNothing) {
  again_.run_plant = nullptr;
  record_run(scene("HingePd", "0.2"), "golden.mcap");
  record_run(scene("HingePdChanged", "0.9"));
  EXPECT_THAT(decided({"/Rig/Camera/*"}), HasSubstr("without physics nothing shows"));
}

TEST_F(PartialAcceptance, OfAnotherBeginningIsRefused) {
  record_run(scene("HingePd", "0.2"), "golden.mcap");
  std::string other = scene("HingePd", "0.9");
  record_run(other.replace(other.find("SHOULDER: 0.3"), 13, "SHOULDER: 0.2"));
  EXPECT_THAT(decided({"/Rig/Camera/*"}), HasSubstr("it would begin in another state than a run of its scenario does"));
}

TEST_F(PartialAcceptance, OfNothingThatMovedSaysWhatDid) {
  record_run(scene("HingePd", "0.2"), "golden.mcap");
  record_run(scene("HingePd", "0.9"));
  EXPECT_EQ(decided({"/Rig/joints"}),
            "nothing of channel /Rig/joints differs from the golden (different: /Rig/Camera/image)");
  EXPECT_THAT(decided({"/Rig/Camara/*"}), HasSubstr("'/Rig/Camara/*' is no channel and no series"));
}

TEST_F(PartialAcceptance, OfRunsThatDoNotFitIntoEachOtherIsRefused) {
  record_run(scene("HingePd", "0.2"), "golden.mcap");
  record_run(scene("HingePd", "0.9", "", "0.2"));
  EXPECT_THAT(decided({"/Rig/Camera/*"}), HasSubstr("the run has 201 ticks and the golden 101"));
  record_run(scene("HingePd", "0.9", "cameras: none\n"));
  EXPECT_THAT(decided({"/Rig/joints"}), HasSubstr("the channel /Rig/Camera/camera_info isn't in the run"));
}

TEST_F(PartialAcceptance, OfSomeJointsOfAMessageMixesThem) {
  record_run(scene("HingePd", "0.2", "cameras: none\n"), "golden.mcap");
  record_run(scene("HingePdChanged", "0.2",
                   "cameras: none\npushes: [{body: Rig, link: SLED, force: [5, 0, 0], from: 0, until: 1}]\n"));
  fs::path kept = path("kept.mcap");
  again_.run_plant = [&](const Scenario& scenario, const Trace& recording, const fs::path& trace,
                         const PlantOptions& options) {
    fs::copy_file(recording.file(), kept);
    return run_plant(scenario, recording, trace, options);
  };
  EXPECT_THAT(decided({"Rig/RAIL/*"}), HasSubstr("no run can produce this golden"));
  const auto candidate = Trace::load(kept), golden = Trace::load(path("golden.mcap")),
             run = Trace::load(path("run.mcap"));
  ASSERT_TRUE(candidate && golden && run);
  EXPECT_EQ(candidate->values("Rig/RAIL/q"), run->values("Rig/RAIL/q"));
  EXPECT_EQ(candidate->values("Rig/SHOULDER/q"), golden->values("Rig/SHOULDER/q"));
  EXPECT_NE(candidate->values("Rig/SHOULDER/q"), run->values("Rig/SHOULDER/q"));
}

TEST_F(PartialAcceptance, IsWrittenIntoTheGoldenWithWhatWasAccepted) {
  setenv("SOURCE_DATE_EPOCH", "1763640000", 1);
  fs::create_directories(path("golden"));
  fs::create_directories(path("pending"));
  GoldenStore store(path("golden"), path("pending"));
  record_run(scene("HingePd", "0.2"));
  ASSERT_TRUE(store.accept("Rig.Turns", path("run.mcap")));
  RecordOptions changed;
  changed.libraries["C"] = "HingePdChanged";
  ASSERT_TRUE(record(load(scene("HingePd", "0.9")), store.pending_file("Rig.Turns"), changed));
  const auto accepted = store.accept_pending("Rig.Turns", {{"/Rig/Camera/image"}, 0.0, std::nullopt}, again_);
  ASSERT_TRUE(accepted) << to_string(accepted.errors());
  EXPECT_FALSE(accepted->whole);
  EXPECT_TRUE(fs::exists(store.pending_file("Rig.Turns")));  // the rest of the run is still pending
  EXPECT_EQ(std::distance(fs::directory_iterator(path("pending")), fs::directory_iterator()), 1);
  EXPECT_THAT(test::read_file(store.digest_file("Rig.Turns")),
              HasSubstr("\naccepted 2025-11-20, partial, of it channel /Rig/Camera/image: differs at tick "));

  EXPECT_FALSE(store.accept_pending("Rig.Turns", {{"Rig/C/output/SHOULDER/u"}, 0.0, std::nullopt}, again_));
  EXPECT_TRUE(store.check_digest("Rig.Turns"));
  unsetenv("SOURCE_DATE_EPOCH");
}

}  // namespace
}  // namespace rehearse
