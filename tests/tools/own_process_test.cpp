// check: each run begins in a process that has run no controller.
#include <gmock/gmock.h>

#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;

class OwnProcesses : public Command {
 protected:
  OwnProcesses() {
    fs::create_directories(folder() / "golden");
    fs::create_directories(folder() / "scenarios");
  }
  /// A scenario with a golden, under this controller.
  void add(const std::string& name, const std::string& library, const std::string& options = "") const {
    const std::string pendulum = read_file(Command::pendulum(library, options));
    write("scenarios/" + name + ".yaml", pendulum + "golden: P." + name + "\n");
  }
};

TEST_F(OwnProcesses, AreThoseOfAllRunsOfACheck) {
  for (const char* name : {"a", "b", "c"}) add(name, COUNTS_RUNS);
  const Outcome written = rehearse({"check", "-j1"}, "REHEARSE_GOLDEN=new");
  EXPECT_EQ(written.status, 0) << written.out << written.err;
  for (const char* jobs : {"-j1", "-j2"}) {
    const nlohmann::json simulated = done({"check", "--simulate", "--json", jobs}).json();
    EXPECT_EQ(simulated["equal"], true) << simulated;
    EXPECT_EQ(simulated["proved"], false);
  }
  done({"check", "-j1"});
  EXPECT_EQ(done({"check", "--json", "-j1"}).json()["proved"], true);
  EXPECT_EQ(done({"check", "--simulate", "--json", "scenarios/a.yaml"}).json()["equal"], true);
}

/// Past the C library, or inside of it: the process can't go on.
TEST_F(OwnProcesses, ThatAControllerEndsAreReportedWithTheirTick) {
  add("a", MISBEHAVING, "exit_group 12");
  for (const char* jobs : {"-j1", "-j2"}) {
    const Outcome outcome = rehearse({"check", jobs, "scenarios/a.yaml", "scenarios/a.yaml"});
    EXPECT_EQ(outcome.status, 3);
    EXPECT_THAT(outcome.err, ContainsRegex("controller 'Pendulum/Swing' ended the process .* in control\\(\\) at tick "
                                           "12 \\(0.012 s\\)"));
  }
}

}  // namespace
}  // namespace rehearse::test
