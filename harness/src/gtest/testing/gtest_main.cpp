// main() of tests that use <rehearse/gtest.h>.
#include <gtest/gtest.h>

#include <string_view>

#include "core/guard/supervise.h"
#include "core/host/source_age.h"
#include "placed_failures.h"
#include "test_process.h"

namespace {

/// Notes the running test and the number of remaining ones, for the report on a controller that ends the process.
class Tasks : public testing::EmptyTestEventListener {
  void OnTestIterationStart(const testing::UnitTest& all, int) override { left_ = all.test_to_run_count(); }
  void OnTestStart(const testing::TestInfo& test) override {
    const std::string name = std::string("test ") + test.test_suite_name() + "." + test.name();
    rehearse::note_task(name.c_str(), --left_);
    rehearse::internal::begin_test();
  }
  int left_ = 0;
};

/// Prints the notes on old libraries if the words are `--gtest_list_tests --rehearse_notes_on LIBRARY...`, as ctest
/// asks at its start (RehearseControllers.cmake). A program with another main() lists its tests, and runs none.
bool told_notes(int argc, char** argv) {
  if (argc < 3 || std::string_view(argv[2]) != "--rehearse_notes_on") return false;
  for (int i = 3; i < argc; ++i) rehearse::tell_old_libraries(rehearse::notes_on_old_library(argv[i]));
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (told_notes(argc, argv)) return 0;
  rehearse::internal::begin_test_process(argv);
  ::testing::InitGoogleTest(&argc, argv);
  ::testing::TestEventListeners& listeners = ::testing::UnitTest::GetInstance()->listeners();
  if (auto* const printer = listeners.Release(listeners.default_result_printer()))
    listeners.Append(new rehearse::internal::PlacedFailures(printer));
  listeners.Append(new Tasks);
  return RUN_ALL_TESTS();
}
