// Timers.
#include "client_library.h"

namespace {

TEST_F(ClientLibrary, ATimerIsCalledOnceAPeriod) {
  int calls = 0;
  const auto timer = node->create_timer(10s, [&] { ++calls; });
  executor->spin_some();
  EXPECT_EQ(calls, 0);
  go_to(11.0);
  executor->spin_some();
  executor->spin_some();
  EXPECT_EQ(calls, 1);
  go_to(21.0);
  executor->spin_some();
  EXPECT_EQ(calls, 2);
}

TEST_F(ClientLibrary, ATimerThatIsLateByWholePeriodsIsCalledOnce) {
  int calls = 0;
  const auto timer = node->create_timer(10s, [&] { ++calls; });
  go_to(35.0);
  executor->spin_all(0s);
  EXPECT_EQ(calls, 1);
  EXPECT_NEAR(std::chrono::duration<double>(timer->time_until_trigger()).count(), 5.0, 1.0);
}

TEST_F(ClientLibrary, ACancelledTimerIsNotCalledUntilItIsReset) {
  int calls = 0;
  const auto timer = node->create_timer(10s, [&] { ++calls; });
  timer->cancel();
  EXPECT_TRUE(timer->is_canceled());
  go_to(30.0);
  executor->spin_some();
  EXPECT_EQ(calls, 0);
  timer->reset();
  go_to(39.0);
  executor->spin_some();
  EXPECT_EQ(calls, 0);
  go_to(41.0);
  executor->spin_some();
  EXPECT_EQ(calls, 1);
}

TEST_F(ClientLibrary, ATimerThatCancelsItselfIsCalledOnce) {
  int calls = 0;
  rclcpp::TimerBase::SharedPtr timer = node->create_timer(1s, [&](rclcpp::TimerBase& self) {
    ++calls;
    self.cancel();
  });
  for (int i = 1; i < 4; ++i) {
    go_to(i);
    executor->spin_some();
  }
  EXPECT_EQ(calls, 1);
}

TEST_F(ClientLibrary, ANegativePeriodIsRefused) {
  EXPECT_THROW((void)node->create_wall_timer(-1s, [] {}), std::invalid_argument);
}

}  // namespace
