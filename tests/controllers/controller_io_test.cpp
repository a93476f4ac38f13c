#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cnoid/ControllerIO>

#include <stdexcept>
#include <string>

#include "bodies.h"
#include "test_io.h"

namespace {

using cnoid::ControllerIO;
using rehearse::test::make_arm;
using rehearse::test::TestIO;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string failure(const std::string& options) {
  try {
    ControllerIO::splitOptions(options);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no failure";
}

TEST(ControllerOptions, AreSplitAtSpaces) {
  EXPECT_THAT(ControllerIO::splitOptions("2, 100"), ElementsAre("2,", "100"));
  EXPECT_THAT(ControllerIO::splitOptions("a\tb"), ElementsAre("a\tb"));
}

TEST(ControllerOptions, LeaveOutEmptyOnes) {
  EXPECT_THAT(ControllerIO::splitOptions(""), IsEmpty());
  EXPECT_THAT(ControllerIO::splitOptions("  a  \"\" b "), ElementsAre("a", "b"));
}

TEST(ControllerOptions, KeepSpacesWithinQuotes) {
  EXPECT_THAT(ControllerIO::splitOptions("\"a b\" c"), ElementsAre("a b", "c"));
  EXPECT_THAT(ControllerIO::splitOptions("x\"a b\"y"), ElementsAre("xa by"));
}

TEST(ControllerOptions, TakeTheCharacterAfterABackslashAsItIs) {
  EXPECT_THAT(ControllerIO::splitOptions(R"(a\ b \"c\" d\\e)"), ElementsAre("a b", "\"c\"", "d\\e"));
  EXPECT_THAT(ControllerIO::splitOptions(R"(a\nb)"), ElementsAre("a\nb"));
  EXPECT_THAT(ControllerIO::splitOptions(R"("a\"b c")"), ElementsAre("a\"b c"));
}

TEST(ControllerOptions, RefuseAnOpenQuoteAndSayWhereItIs) {
  EXPECT_THAT(failure("a \"b c"), HasSubstr("character 3: a quote is opened and never closed"));
}

TEST(ControllerOptions, RefuseAnUnknownEscape) {
  EXPECT_THAT(failure(R"(C:\temp)"), HasSubstr("character 3: a backslash stands before 't'"));
  EXPECT_THAT(failure("a\\"), HasSubstr("character 2: a backslash ends it"));
}

TEST(ControllerIO, SplitsItsOwnOptionString) {
  TestIO io(make_arm());
  io.options_text = "torque \"two words\"";
  EXPECT_THAT(io.options(), ElementsAre("torque", "two words"));
}

TEST(ControllerIO, ReadsItsOptionsAsAMapping) {
  TestIO io(make_arm());
  EXPECT_TRUE(io.structuredOptions()->empty());
  io.options_text = "{ speed: 0.5, legs: [ left, right ] }";
  const cnoid::MappingPtr options = io.structuredOptions();
  EXPECT_EQ(options->get("speed", 0.0), 0.5);
  EXPECT_EQ(options->findListing("legs")->size(), 2);
  EXPECT_EQ(io.messages.str(), "");
}

TEST(ControllerIO, SaysWhyItsOptionsAreNoMapping) {
  TestIO io(make_arm());
  io.options_text = "fast";
  EXPECT_EQ(io.structuredOptions(), nullptr);
  EXPECT_EQ(io.messages.str(), "tested: the options are no YAML mapping (name: value): fast\n");
  io.options_text = "{ speed: 0.5";
  EXPECT_EQ(io.structuredOptions(), nullptr);
  EXPECT_THAT(io.messages.str(), HasSubstr("tested: the options are no YAML: line 1, column"));
}

TEST(ControllerIO, MarksWarningsAndErrorsOnItsStream) {
  TestIO io(make_arm());
  io.mout()->putln("ready");
  io.mout()->putWarningln("the floor is wet");
  io.mout()->putErrorln("Error: fallen");
  EXPECT_EQ(io.messages.str(), "ready\nWarning: the floor is wet\nError: fallen\n");
  EXPECT_TRUE(io.mout()->hasErrors());
}

TEST(ControllerIO, AcceptsTheLogsOfChoreonoidAndDoesNothing) {
  struct Frame : cnoid::Referenced {
    explicit Frame(bool& is_gone) : gone(is_gone) {}
    ~Frame() override { gone = true; }
    bool& gone;
  };
  TestIO io(make_arm());
  bool gone = false;
  EXPECT_FALSE(io.enableLog());
  EXPECT_EQ(io.logBodyMotion(), nullptr);
  EXPECT_FALSE(io.sigLogFlushRequested().connect([] {}).connected());
  io.outputLogFrame(new Frame(gone));
  EXPECT_TRUE(gone);
  EXPECT_TRUE(io.isSimulationFromInitialState());
}

TEST(ControllerIO, GivesItsTimeStepUnderTheOldNameToo) {
  const TestIO io(make_arm());
  EXPECT_EQ(io.worldTimeStep(), io.timeStep());
}

}  // namespace
