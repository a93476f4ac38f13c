// Controllers that change or end their process: an audit reports this in a sentence and is not affected.
#include "audited.h"

#include <gmock/gmock.h>

namespace rehearse::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class BadManners : public Audited {
 protected:
  Outcome audited(const std::string& deed, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"audit", scenario("bad_manners", deed).string()};
    words.insert(words.end(), more.begin(), more.end());
    return rehearse(words);
  }
};

TEST_F(BadManners, ACrashIsAFailure) {
  const Outcome outcome = audited("crash");
  EXPECT_EQ(outcome.status, 3) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, ContainsRegex("^failed: (.*: |)controller 'Pendulum/Zoo' crashed: segmentation fault"));
  EXPECT_THAT(outcome.out, HasSubstr("in control() at tick 7"));
}

TEST_F(BadManners, AnExceptionIsAFailure) {
  const Outcome outcome = audited("throw");
  EXPECT_EQ(outcome.status, 3) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out,
              StartsWith("failed: controller 'Pendulum/Zoo' threw std::runtime_error: no gait for this slope"));
}

TEST_F(BadManners, AbortIsAFailure) {
  const Outcome outcome = audited("abort");
  EXPECT_EQ(outcome.status, 3) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, StartsWith("failed: controller 'Pendulum/Zoo' crashed: it called abort"));
}

TEST_F(BadManners, AHangIsAFailure) {
  const Outcome outcome = audited("hang", {"--call-limit", "0.2"});
  EXPECT_EQ(outcome.status, 3) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, StartsWith("failed: controller 'Pendulum/Zoo' did not return within 0.2 s in control()"));
}

TEST_F(BadManners, LeavingTheProcessIsAFailure) {
  for (const char* deed : {"exit", "quick"}) {
    const Outcome outcome = audited(deed);
    EXPECT_EQ(outcome.status, 3) << deed << outcome.out << outcome.err;
    EXPECT_THAT(outcome.out, ContainsRegex("^failed: controller 'Pendulum/Zoo' .*exit.* in control\\(\\) at tick 7"));
  }
}

TEST_F(BadManners, WhatConcernsTheWholeProcessIsSaid) {
  const Outcome moved = audited("chdir");
  EXPECT_THAT(moved.err, HasSubstr("Pendulum/Zoo: changes the working folder of the whole process by chdir(/)"));
  EXPECT_EQ(moved.status, 0) << moved.out;
  const Outcome deaf = audited("signal");
  EXPECT_THAT(deaf.err, HasSubstr("changes how the whole process takes a signal"));
  EXPECT_EQ(deaf.status, 0) << deaf.out;
  const Outcome rounding = audited("float");
  EXPECT_THAT(rounding.err, HasSubstr("floating-point mode"));
  EXPECT_EQ(rounding.status, 0) << rounding.out;
}

TEST_F(BadManners, ClosingWhatIsOpenHurtsNobody) {
  const Outcome outcome = audited("close");  // files that a run needs can't be closed
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("Pendulum/Zoo: closes a file descriptor that isn't its own by close("));
  done({"record", scenario("good_own_generator", "close").string(), "-o", "zoo.mcap"});
  // on given inputs nothing hangs on what is open
  const Outcome replayed = rehearse({"audit", "zoo.mcap", "--controller", "Zoo=" ZOO "/zoo_bad_manners.so"});
  EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
  EXPECT_THAT(replayed.err, HasSubstr("closes"));
}

}  // namespace
}  // namespace rehearse::test
