// Reading memcheck's XML reports.
#include "audit/audit/valgrind_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rehearse {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const std::string begin = "<?xml version=\"1.0\"?>\n<valgrindoutput>\n", end = "</valgrindoutput>\n";

std::string frame(const std::string& library, const std::string& function, int line) {
  return "<frame><ip>0x1</ip><obj>" + library + "</obj><fn>" + function +
         "</fn><dir>/src</dir><file>filter.cpp</file><line>" + std::to_string(line) + "</line></frame>";
}

std::string found(const std::string& kind, const std::string& frames, const std::string& more = "") {
  return "<error><kind>" + kind + "</kind><what>w</what><stack>" + frames + "</stack>" + more + "</error>\n";
}

TEST(ValgrindReport, NamesTheInnermostPlaceInAControllersLibrary) {
  const std::string stack = frame("/lib/libc.so.6", "memcpy", 1) + frame("/c/Filter.so", "Filter::update()", 31) +
                            frame("/c/Filter.so", "Filter::control()", 40);
  EXPECT_THAT(memory_errors_in(begin + found("InvalidRead", stack) + end, {"/c/Filter.so"}),
              ElementsAre("memory is read that is not its own in Filter::update() (filter.cpp:31)"));
}

TEST(ValgrindReport, SaysWhereAValueThatWasNeverSetComesFrom) {
  const std::string origin = "<auxwhat>Uninitialised value was created by a heap allocation</auxwhat><stack>" +
                             frame("/lib/libstdc++.so", "operator new", 1) + frame("/c/Filter.so", "create()", 50) +
                             "</stack>";
  EXPECT_THAT(
      memory_errors_in(begin + found("UninitCondition", frame("/c/Filter.so", "step()", 9), origin) + end,
                       {"/c/Filter.so"}),
      ElementsAre("a branch depends on a value that was never set in step() (filter.cpp:9): Uninitialised value was "
                  "created by a heap allocation, in create() (filter.cpp:50)"));
}

TEST(ValgrindReport, LeavesOutWhatIsNotTheControllers) {
  EXPECT_THAT(memory_errors_in(begin + found("InvalidRead", frame("/lib/libfoo.so", "foo", 1)) +
                                   found("Leak_DefinitelyLost", frame("/c/Filter.so", "leak", 1)) + end,
                               {"/c/Filter.so"}),
              IsEmpty());
}

TEST(ValgrindReport, SaysEachOnce) {
  const std::string twice = found("InvalidWrite", frame("/c/Filter.so", "step()", 9));
  EXPECT_THAT(memory_errors_in(begin + twice + twice + end, {"/c/Filter.so"}), ElementsAre(::testing::_));
}

TEST(ValgrindReport, MayEndInItsMidst) {
  const std::string one = found("InvalidWrite", frame("/c/Filter.so", "step()", 9));
  EXPECT_THAT(memory_errors_in(begin + one + "<error><kind>Invalid", {"/c/Filter.so"}), ElementsAre(::testing::_));
  EXPECT_THAT(memory_errors_in(begin, {"/c/Filter.so"}), IsEmpty());
  EXPECT_THAT(memory_errors_in("no XML at all", {"/c/Filter.so"}), IsEmpty());
}

}  // namespace
}  // namespace rehearse
