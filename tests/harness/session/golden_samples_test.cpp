// Goldens that keep samples of the state: `golden: {state: 100 Hz}`.
#include <rehearse/golden.h>
#include <rehearse/session.h>

#include "core/trace/run_facts.h"
#include "runs.h"
#include "support/files.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class GoldenSamples : public RunTest {
 protected:
  static constexpr const char* name = "Rig.Turns";

  /// The wheel under a controller; `more` are further lines.
  static std::string scene(const std::string& golden, const std::string& more = "",
                           const std::string& library = "HingePd") {
    return "rehearse: 1\nduration: 0.1\ngolden: " + golden +
           "\nbodies:\n  - name: Rig\n    model: rig.urdf\n    joints: {SHOULDER: 0.3}\n"
           "    controllers: [{name: C, library: " +
           library + "}]\n" + more;
  }

  void accept(const std::string& text) {
    record_run(text);
    const auto accepted = store_.accept(name, path("run.mcap"));
    ASSERT_TRUE(accepted) << to_string(accepted.errors());
  }
  Trace golden() const {
    auto trace = Trace::load(store_.trace_file(name));
    EXPECT_TRUE(trace) << to_string(trace.errors());
    return *std::move(trace);
  }
  static std::size_t messages(const Trace& trace, const char* topic) {
    const TraceChannel* channel = trace.find_channel(topic);
    EXPECT_NE(channel, nullptr) << topic;
    return channel ? channel->messages() : 0;
  }

  GoldenStore store_{path("golden"), path("pending")};
};

TEST_F(GoldenSamples, AreOfTheStateAlone) {
  accept(scene("{state: 100 Hz}", "expect: [{channel: Rig/Force/force/x, below: 1000}]\n"));
  const Trace kept = golden(), run = *Trace::load(path("run.mcap"));
  for (const char* topic : {"/Rig/joints", "/Rig/Imu/imu", "/Rig/Gyro/imu"}) {
    EXPECT_EQ(messages(kept, topic), (messages(run, topic) + 9) / 10) << topic;
    for (const std::uint64_t time : kept.find_channel(topic)->times) EXPECT_EQ(time % 10'000'000, 0u) << topic;
  }
  for (const TraceChannel& channel : run.channels()) {
    const bool is_reduced = RunFacts::of(kept).state_rate->reduces(channel.topic);
    EXPECT_EQ(messages(kept, channel.topic.c_str()) == channel.messages(), !is_reduced) << channel.topic;
  }
  EXPECT_EQ(messages(kept, "/Rig/Force/wrench"), 100u);  // an expectation reads it
  EXPECT_EQ(messages(kept, "/Rig/C/input/joints"), 100u);
  EXPECT_EQ(messages(kept, "/tick"), 101u);
  EXPECT_TRUE(store_.check_digest(name));
  EXPECT_THAT(test::read_file(store_.digest_file(name)),
              HasSubstr("state, of which samples are kept\n  rate: 100\n  time_step: 0.001\n"
                        "  whole./Rig/Force/wrench: every tick\n"));
}

TEST_F(GoldenSamples, AreComparedWithThoseOfARunInEitherOrder) {
  accept(scene("{state: 100 Hz}"));
  const fs::path kept = store_.trace_file(name), run = path("run.mcap");
  EXPECT_TRUE(compare(golden(), *Trace::load(run), {}).equal);
  EXPECT_TRUE(compare(*Trace::load(run), golden(), {}).equal);
  EXPECT_TRUE(compare(kept, run, {})->equal);
  EXPECT_TRUE(compare(run, kept, {})->equal);
  EXPECT_TRUE(compare(kept, kept, {})->equal);
  EXPECT_LT(compare(kept, run, {})->values, compare(run, run, {})->values);
}

TEST_F(GoldenSamples, ThatAreEqualDontHideADifferenceBetweenThem) {
  accept(scene("{state: 100 Hz}"));
  record_run(
      scene("{state: 100 Hz}", "pushes: [{body: Rig, link: SLED, force: [1, 0, 0], from: 0.011, until: 0.013}]\n"));
  const auto compared = compare(store_.trace_file(name), path("run.mcap"), {});
  ASSERT_TRUE(compared);
  ASSERT_TRUE(compared->first_bit && compared->first);
  EXPECT_EQ(compared->first_bit->tick, 12);  // the hash of the state
  EXPECT_EQ(compared->first_bit->channel, "/tick");
  EXPECT_EQ(compared->first->tick, 20);
  EXPECT_EQ(compared->first->channel, "/Rig/joints");
}

TEST_F(GoldenSamples, AreAcceptedOnceAndAnewWithAnotherRate) {
  accept(scene("{state: 100 Hz}"));
  const auto again = store_.accept(name, path("run.mcap"));
  ASSERT_TRUE(again);
  EXPECT_FALSE(again->changed);
  accept(scene("{state: 500 Hz}"));
  EXPECT_EQ(messages(golden(), "/Rig/joints"), 51u);
  accept(scene("Rig.Turns"));
  EXPECT_EQ(messages(golden(), "/Rig/joints"), 101u);
  EXPECT_FALSE(RunFacts::of(golden()).state_rate);
  for (const auto& entry : fs::directory_iterator(path("golden")))
    EXPECT_TRUE(entry.path().extension() == ".mcap" || entry.path().extension() == ".txt") << entry.path();
}

TEST_F(GoldenSamples, StayIfAPartOfARunIsAccepted) {
  const auto wall = [](const char* red) {
    return std::string("  - name: Wall\n    box: {size: [9, 0.5, 9], color: [") + red +
           ", 0.2, 0.2]}\n    fixed: true\n    position: [0, -4, 0]\n";
  };
  accept(scene("{state: 100 Hz}", wall("0.2")));
  RecordOptions changed;
  changed.libraries["C"] = "HingePdChanged";
  ASSERT_TRUE(record(load(scene("{state: 100 Hz}", wall("0.9"))), path("changed.mcap"), changed));
  fs::create_directories(path("pending"));
  fs::copy_file(path("changed.mcap"), store_.pending_file(name));
  Reexecution again;
  again.run_plant = run_plant;
  const auto accepted = store_.accept_pending(name, {{"/Rig/Camera/image"}, 0.0, std::nullopt}, again);
  ASSERT_TRUE(accepted) << to_string(accepted.errors());
  EXPECT_FALSE(accepted->whole);
  EXPECT_EQ(messages(golden(), "/Rig/joints"), 11u);
  record_run(scene("{state: 100 Hz}", wall("0.9")));
  EXPECT_TRUE(compare(store_.trace_file(name), path("run.mcap"), {})->equal);

  ASSERT_TRUE(record(load(scene("{state: 500 Hz}", wall("0.9"))), store_.pending_file(name), changed));
  const auto refused = store_.accept_pending(name, {{"/Rig/Camera/image"}, 0.0, std::nullopt}, again);
  ASSERT_FALSE(refused);
  EXPECT_EQ(to_string(refused.errors()[0]),
            "error: the golden keeps the state at another rate than the run's scenario asks for (accept all of the "
            "run)");
}

TEST_F(GoldenSamples, ReplayLikeTheWholeRun) {
  accept(scene("{state: 100 Hz}"));
  const auto whole = replay(path("run.mcap"), {}), samples = replay(store_.trace_file(name), {});
  ASSERT_TRUE(whole && samples);
  EXPECT_TRUE(samples->equal());
  EXPECT_TRUE(samples->repeats_the_run);
  EXPECT_EQ(samples->ticks, whole->ticks);
  EXPECT_EQ(samples->values, whole->values);
}

}  // namespace
}  // namespace rehearse
