// Recordings of other versions: compared as far as possible; differences caused by the version alone are allowed.
#include "compare_fixture.h"

namespace rehearse {
namespace {

using testing::Compare;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST_F(Compare, RemarksOnAnotherScenarioAndOtherLibraries) {
  actual_.scenario = "rehearse: 1\nseed: 2\n";
  actual_.provenance["rehearse"] = "0.2.0";
  const Comparison comparison = compared();
  EXPECT_TRUE(comparison.equal);
  EXPECT_THAT(comparison.remarks, ElementsAre("scenario.yaml has changed since the golden was recorded",
                                              "rehearse was \"0.1.0\" and is \"0.2.0\": everything may differ for that "
                                              "alone"));
}

TEST_F(Compare, NamesWhatMayExplainADifferenceOfThatPart) {
  golden_.provenance["physics"] = "ODE 0.16.2";
  actual_.provenance["physics"] = "ODE 0.16.4";
  actual_.ticks[1].q = 0.6;
  EXPECT_EQ(compared().explanation, "the physics engine");
  EXPECT_THAT(verdict(compared()), HasSubstr("at tick 1; changed since the golden: the physics engine"));
  EXPECT_THAT(compared().remarks, Contains(HasSubstr("physics, sensors and inputs may differ for that alone")));
  EXPECT_FALSE(compared().same_arithmetic);
  actual_.ticks[1].q = 0.5;
  actual_.ticks[1].u = 13.0;
  EXPECT_EQ(compared().explanation, "") << "no commands depend on it";
}

TEST_F(Compare, BlamesNoRendererForTheState) {
  golden_.provenance["renderer"] = "llvmpipe (LLVM 15.0.6), Mesa 22.3.6";
  actual_.provenance["renderer"] = "llvmpipe (LLVM 19.1.7), Mesa 25.0.7";
  actual_.ticks[1].q = 0.6;
  EXPECT_EQ(compared().explanation, "");
  actual_.ticks[1].q = 0.5;
  actual_.ticks[1].image.pixels[3] = 103;
  EXPECT_EQ(compared().explanation, "the renderer");
}

TEST_F(Compare, BlamesAProcessorOnlyWhereNothingWasPinned) {
  golden_.provenance["processor"] = "one";
  actual_.provenance["processor"] = "another";
  actual_.ticks[1].q = 0.6;
  EXPECT_EQ(compared().explanation, "the processor");
  for (auto* trace : {&golden_, &actual_}) {
    trace->provenance["pinned.GLIBC_TUNABLES"] = "glibc.cpu.hwcaps=x";
    trace->provenance["pinned.GALLIUM_OVERRIDE_CPU_CAPS"] = "sse4.1";
  }
  EXPECT_EQ(compared().explanation, "");
  EXPECT_THAT(compared().remarks, Contains(HasSubstr("\"one\" and is \"another\"")));
}

TEST_F(Compare, NamesAnotherProcessorArchitectureInEitherRecording) {
  actual_.ticks[1].q = 0.6;
  actual_.provenance["architecture"] = "arm64";
  EXPECT_EQ(compared().explanation, "the processor architecture");
  EXPECT_FALSE(compared().same_arithmetic);
  EXPECT_THAT(compared().remarks, ElementsAre("the processor architecture was \"x86-64\" and is \"arm64\": everything "
                                              "may differ for that alone"));
  std::swap(golden_.provenance, actual_.provenance);
  EXPECT_THAT(compared().remarks, Contains(HasSubstr("was \"arm64\" and is \"x86-64\"")));
  actual_.provenance["architecture"] = "arm64";
  EXPECT_TRUE(compared().same_arithmetic);
}

TEST_F(Compare, SaysOnceThatOneProcessWasPinned) {
  golden_.provenance["pinned"] = "yes";
  golden_.provenance["pinned.GLIBC_TUNABLES"] = "glibc.cpu.hwcaps=x";
  actual_.provenance["pinned"] = "no (REHEARSE_PIN=off)";
  EXPECT_THAT(compared().remarks,
              ElementsAre("pinned was \"yes\" and is \"no (REHEARSE_PIN=off)\": everything may differ "
                          "for that alone"));
  EXPECT_FALSE(compared().same_arithmetic);
  golden_.provenance["pinned"] = "no (the program didn't pin itself)";
  golden_.provenance.erase("pinned.GLIBC_TUNABLES");
  EXPECT_TRUE(compared().remarks.empty()) << "the reason changes no bit";
  EXPECT_TRUE(compared().same_arithmetic);
}

TEST_F(Compare, SaysThatTheProgramWasBuiltWithOtherFlags) {
  actual_.provenance["build"] = "other flags: -mfma";
  EXPECT_THAT(compared().remarks,
              ElementsAre("the build was \"usual flags\" and is \"other flags: -mfma\": everything may "
                          "differ for that alone"));
  EXPECT_FALSE(compared().same_arithmetic);
}

TEST_F(Compare, NamesTheControllerWhoseLibraryIsAnotherOne) {
  golden_.provenance["controller.Robot/Pd"] = "Pd.so 1";
  actual_.provenance["controller.Robot/Pd"] = "Pd.so 2";
  actual_.ticks[1].u = 13.0;
  EXPECT_EQ(compared().explanation, "controller 'Robot/Pd'");
  CompareOptions plant;
  plant.stages = {Stage::physics, Stage::sensors, Stage::renderer};
  EXPECT_TRUE(compared({}, plant).remarks.empty()) << "a plant has no controllers";
}

TEST_F(Compare, RefusesARecordingOfAVersionItDoesNotKnow) {
  golden_.provenance["trace_version"] = "2";
  const Comparison comparison = compared();
  EXPECT_FALSE(comparison.within);
  EXPECT_TRUE(comparison.channels.empty());
  EXPECT_THAT(verdict(comparison), HasSubstr("can't be compared: "));
  EXPECT_THAT(verdict(comparison),
              HasSubstr("golden.mcap: it is of trace version 2, and this program reads version 1"));
  EXPECT_THAT(verdict(comparison), HasSubstr("install the version of Rehearse that wrote it: 0.1.0"));
}

TEST_F(Compare, ComparesWhatNoneOfOursHasWritten) {
  golden_.provenance.clear();
  actual_.provenance.clear();
  EXPECT_TRUE(compared().equal);
}

TEST_F(Compare, WarnsOfRulesThatHoldForNothing) {
  ToleranceRule nothing = rule("Robot/KNEEE/q");
  nothing.place = {"loose.yaml", 3, 5};
  nothing.atol = 1.0;
  const Comparison comparison = compared({rule("Robot/*"), nothing, rule("Robot/Eye/image"), rule("tick")});
  ASSERT_EQ(comparison.warnings.size(), 1u);
  EXPECT_TRUE(comparison.equal);
  EXPECT_EQ(table(comparison),
            "  loose.yaml:3:5: warning: the tolerance of 'Robot/KNEEE/q' applies to nothing: neither trace has such a "
            "channel (a golden's digest lists the names, for example SR1/RLEG_KNEE/q)\n");
}

}  // namespace
}  // namespace rehearse
