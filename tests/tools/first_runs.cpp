// A user's test program: run by own_process_test.cpp, not by ctest.
#include <rehearse/gtest.h>
#include <rehearse/renderer.h>

namespace {

TEST(Pendulum, IsAsItsGolden) { EXPECT_MATCHES_GOLDEN(rehearse::record("pendulum.yaml")); }

TEST(Pendulum, IsTheSecondTimeAsItsGolden) {
  rehearse::record("pendulum.yaml");
  EXPECT_MATCHES_GOLDEN(rehearse::record("pendulum.yaml"), rehearse::Exact{},
                        rehearse::Levels{rehearse::Level::controller, rehearse::Level::closed});
}

TEST(Replay, IsAsTheGolden) { EXPECT_REPLAYS("Pendulum.IsAsItsGolden"); }
TEST(Replay, IsTheSecondTimeAsTheGolden) { EXPECT_REPLAYS("Pendulum.IsAsItsGolden"); }

/// Without a golden it is red: its report has a picture, which this process draws.
TEST(Eye, IsRed) { EXPECT_MATCHES_GOLDEN(rehearse::record("eye.yaml")); }

TEST(Eye, SeesAfterThisProcessHasDrawn) {
  ASSERT_TRUE(rehearse::Renderer::create());
  EXPECT_NE(rehearse::record("eye.yaml").find_channel("/Eye/Lens/image"), nullptr);
}

}  // namespace
