// main() of tests that use <rehearse/gtest.h>.
#include <gtest/gtest.h>

#include "core/guard/supervise.h"
#include "placed_failures.h"
#include "test_process.h"

namespace {

/// Notes the running test and the number of remaining ones, for the report on a controller that ends the process.
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
  rehearse::internal::begin_test_process(argv);
  ::testing::InitGoogleTest(&argc, argv);
  ::testing::TestEventListeners& listeners = ::testing::UnitTest::GetInstance()->listeners();
  if (auto* const printer = listeners.Release(listeners.default_result_printer()))
    listeners.Append(new rehearse::internal::PlacedFailures(printer));
  listeners.Append(new Tasks);
  return RUN_ALL_TESTS();
}
