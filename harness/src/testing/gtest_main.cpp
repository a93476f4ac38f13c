// main() of tests that use <rehearse/gtest.h>.
#include <gtest/gtest.h>
#include <rehearse/pin.h>

#include "host/supervise.h"

namespace {

/// Which test runs and how many are left, for the report on a controller that ends the process.
class Tasks : public testing::EmptyTestEventListener {
  void OnTestIterationStart(const testing::UnitTest& all, int) override { left_ = all.test_to_run_count(); }
  void OnTestStart(const testing::TestInfo& test) override {
    const std::string name = std::string("test ") + test.test_suite_name() + "." + test.name();
    rehearse::note_task(name.c_str(), --left_);
  }
  int left_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  rehearse::pin_process(argv);  // first: it starts the program once more, and nothing may have computed by then
  rehearse::supervise_process();
  ::testing::InitGoogleTest(&argc, argv);
  ::testing::UnitTest::GetInstance()->listeners().Append(new Tasks);
  return RUN_ALL_TESTS();
}
