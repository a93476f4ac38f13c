// Changes that aren't faults: the bits equal the golden's, or nearly, although the files differ.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <regex>

#include "standing_robot.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class Innocents : public ::testing::Test {
 protected:
  CheckReport checked(const CheckOptions& options = {}) const {
    auto report = robot_.check(options);
    EXPECT_TRUE(report.ok()) << to_string(report.errors());
    return report ? *std::move(report) : CheckReport();
  }
  /// The scenario with the entries of `bodies:` in the opposite order.
  void reverse_bodies() const {
    const std::string text = test::read_file(robot_.file("scenario.yaml"));
    const std::size_t begin = text.find("bodies:\n") + 8, end = text.find("noise:\n");
    std::vector<std::string> entries;
    for (std::size_t at = begin; at < end;) {
      const std::size_t next = std::min(end, text.find("  - name:", at + 1));
      entries.insert(entries.begin(), text.substr(at, next - at));
      at = next;
    }
    std::string bodies;
    for (const std::string& entry : entries) bodies += entry;
    robot_.write("scenario.yaml", text.substr(0, begin) + bodies + text.substr(end));
  }
  /// The robot's model with its joints in the opposite order.
  void reverse_joints() const {
    const std::string text = test::read_file(robot_.file("sr1.urdf"));
    const std::regex joint(R"(  <joint name=[^]*?</joint>\n)");
    std::vector<std::string> joints;
    for (std::sregex_iterator it(text.begin(), text.end(), joint), end; it != end; ++it)
      joints.insert(joints.begin(), it->str());
    ASSERT_GT(joints.size(), 20u);
    std::string without = std::regex_replace(text, joint, "");
    const std::size_t end = without.rfind("</robot>");
    for (const std::string& one : joints) without.insert(without.rfind("</robot>"), one);
    ASSERT_NE(end, std::string::npos);
    robot_.write("sr1.urdf", without);
  }

  StandingRobot robot_;
};

TEST_F(Innocents, ALineThatIsLoggedIsNoFault) {
  robot_.record_golden();
  CheckOptions options;
  options.run.libraries["Stand"] = "StandWith_words";
  const CheckReport report = checked(options);
  EXPECT_TRUE(report.within()) << report.verdict.text();
  EXPECT_EQ(report.controller, LevelState::equal);
  EXPECT_EQ(report.closed, LevelState::within);
  EXPECT_THAT(report.verdict.text(), HasSubstr("the controllers' lines differ from tick"));
}

TEST_F(Innocents, ALibraryUnderAnotherNameIsNoFaultThoughTheOldOneIsGone) {
  std::filesystem::copy_file(VERDICT_CONTROLLERS "/StandWith_none.so", robot_.file("first.so"));
  robot_.apply({"scenario.yaml", "library: StandWith_none", "library: first.so"});
  robot_.record_golden();
  std::filesystem::rename(robot_.file("first.so"), robot_.file("second.so"));
  robot_.apply({"scenario.yaml", "library: first.so", "library: second.so"});
  const CheckReport report = checked();
  EXPECT_TRUE(report.equal()) << report.verdict.text();
}

TEST_F(Innocents, CheckpointsFitTheirOwnBodiesInWhateverOrderTheseStand) {
  robot_.record_golden();
  reverse_bodies();
  const CheckReport report = checked();
  EXPECT_EQ(report.controller, LevelState::equal) << report.verdict.text();
  ASSERT_TRUE(report.plant_comparison) << report.verdict.text();
  EXPECT_TRUE(report.plant_comparison->within) << report.verdict.text() << "\n" << table(*report.plant_comparison);
}

// Where feet touch, the order of joints decides between solutions that are all right: here they don't touch yet.
TEST_F(Innocents, CheckpointsFitTheirOwnJointsInWhateverOrderTheseStand) {
  robot_.apply({"scenario.yaml", "duration: 0.6", "duration: 0.03"});
  RecordOptions often;
  often.checkpoint_period = 0.01;
  robot_.record_golden(often);
  reverse_joints();
  const CheckReport report = checked();
  ASSERT_TRUE(report.plant_comparison) << report.verdict.text();
  EXPECT_TRUE(report.plant_comparison->within) << report.verdict.text() << "\n" << table(*report.plant_comparison);
}

TEST_F(Innocents, TwoEqualBoxesThatTradePlacesInTheFileStayWhereTheyAre) {
  robot_.write("scenario.yaml", R"(rehearse: 1
duration: 0.5
bodies:
  - {name: Floor, box: {size: [10, 10, 0.2]}, fixed: true, position: [0, 0, -0.1]}
  - {name: Left, box: {size: [0.2, 0.2, 0.2]}, mass: 1, position: [0, 1.5, 0.3]}
  - {name: Right, box: {size: [0.2, 0.2, 0.2]}, mass: 1, position: [0, -1.5, 0.25]}
)");
  robot_.record_golden();
  std::string text = test::read_file(robot_.file("scenario.yaml"));
  const std::size_t left = text.find("  - {name: Left"), right = text.find("  - {name: Right");
  robot_.write("scenario.yaml", text.substr(0, left) + text.substr(right) + text.substr(left, right - left));
  const CheckReport report = checked();
  ASSERT_TRUE(report.plant_comparison && report.plant_comparison->worst) << report.verdict.text();
  EXPECT_LT(report.plant_comparison->worst->difference, 1e-5)
      << report.verdict.text();  // the bodies are three metres apart
}

TEST_F(Innocents, AControllerIsNeverCalledNondeterministicIfTwoReplaysAgree) {
  robot_.record_golden();
  for (const char* library : {"StandWith_no_delay", "StandWith_gain", "StandWith_late", "StandWith_words"}) {
    CheckOptions options;
    options.run.libraries["Stand"] = library;
    EXPECT_THAT(checked(options).verdict.text(), Not(HasSubstr("something besides its recorded inputs"))) << library;
  }
}

/// The golden's provenance names different functions of the maths library, the last bits of the controller's gains
/// differ, and a link has a different mass.
TEST_F(Innocents, AControllerIsNotBlamedForTheLastBitsOfAnotherArithmetic) {
  const char* const known = std::getenv("GLIBC_TUNABLES");
  const std::string tunables = known ? known : "";
  setenv("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-NONE_SUCH", 1);  // glibc has read them: this only names them
  robot_.record_golden();
  known ? setenv("GLIBC_TUNABLES", tunables.c_str(), 1) : unsetenv("GLIBC_TUNABLES");
  robot_.apply(
      {"scenario.yaml", "library: StandWith_none}", "library: StandWith_none, options: \"1.0000000000000002\"}"});
  robot_.apply({"sr1.urdf", R"(<mass value="5.1"/>)", R"(<mass value="5.101"/>)"});
  CheckOptions closed_only;
  closed_only.controller = closed_only.plant = false;
  const CheckReport report = checked(closed_only);
  EXPECT_EQ(report.closed, LevelState::differs);
  EXPECT_THAT(report.verdict.text(), Not(HasSubstr("the controller changed")));
  EXPECT_THAT(
      report.verdict.text(),
      ::testing::StartsWith("sr1.urdf:94 (link RLEG_HIP_Y/inertial/mass/value is 5.101, was 5.1) changed: under the "
                            "golden's commands, SR1/"));
  ASSERT_TRUE(report.first);
  EXPECT_EQ(report.first->stage, Stage::physics) << report.verdict.text();
}

}  // namespace
}  // namespace rehearse
