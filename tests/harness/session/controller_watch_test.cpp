// The calls of a ControllerWatch during a recording and during a replay.
#include "core/host/controller_watch.h"

#include <utility>

#include "runs.h"

namespace rehearse {
namespace {

using ::testing::ElementsAre;

/// Records its calls.
struct Notes : ControllerWatch {
  void enter(const ControllerCall& call) override {
    EXPECT_FALSE(inside);
    inside = true;
    calls.push_back(call.controller + " " + call.function + " " + std::to_string(call.tick));
    libraries.push_back(call.library);
    last_time = call.time;
  }
  void leave() override {
    EXPECT_TRUE(inside);
    inside = false;
  }
  bool inside = false;
  std::vector<std::string> calls;
  std::vector<std::filesystem::path> libraries;
  double last_time = 0.0;
};

class ControllerWatching : public RunTest {
 protected:
  /// A run of three ticks.
  void record_watched(const std::string& options) {
    RecordOptions recording;
    recording.watch = &notes_;
    const auto recorded =
        record(load(rig(behaviour("A", options), "cameras: none\n", "0.003")), path("run.mcap"), recording);
    ASSERT_TRUE(recorded.ok()) << to_string(recorded.errors());
  }
  Notes notes_;
};

TEST_F(ControllerWatching, IsToldOfEachCall) {
  record_watched("narrate");
  EXPECT_THAT(notes_.calls,
              ElementsAre("Rig/A load -1", "Rig/A createSimpleController 0", "Rig/A configure 0", "Rig/A initialize 0",
                          "Rig/A start 0", "Rig/A control 0", "Rig/A control 1", "Rig/A control 2", "Rig/A stop 2",
                          "Rig/A unconfigure 2", "Rig/A ~SimpleController 2"));
  for (const auto& library : notes_.libraries) EXPECT_TRUE(library.is_absolute()) << library;
  EXPECT_NEAR(notes_.last_time, 0.002, 1e-12);
  EXPECT_FALSE(notes_.inside);
}

TEST_F(ControllerWatching, IsToldOfTheEndOfACallThatFailed) {
  record_watched("fail throw control 1");
  EXPECT_FALSE(notes_.inside);
  EXPECT_THAT(notes_.calls, ::testing::Contains("Rig/A control 1"));
  EXPECT_THAT(notes_.calls, ::testing::Not(::testing::Contains("Rig/A control 2")));
}

TEST_F(ControllerWatching, IsToldOfAReplayToo) {
  record_watched("narrate");
  const std::vector<std::string> recorded = std::exchange(notes_.calls, {});
  ReplayOptions options;
  options.watch = &notes_;
  ASSERT_TRUE(replay_run(options).ok());
  EXPECT_EQ(notes_.calls, recorded);
}

}  // namespace
}  // namespace rehearse
