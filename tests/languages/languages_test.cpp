// Controllers in C, Rust and Python: the same bits as in C++, each function, and failures with their ticks.
#include <gmock/gmock.h>
#include <rehearse/messages.h>
#include <rehearse/trace.h>

#include <map>
#include <regex>
#include <sstream>

#include "../tools/command.h"
#include "support/sanitized.h"

namespace rehearse::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;

class Languages : public Command {
 protected:
  // A controller that failed isn't called again, so its memory is never freed.
  const std::string no_leak_check_ = "ASAN_OPTIONS=detect_leaks=0";

  /// A scenario of the fixtures with a different controller for its robot, and a shorter duration [s].
  fs::path with_controller(const std::string& scenario, const std::string& old, const fs::path& library,
                           const std::string& name, const std::string& options, const std::string& duration) const {
    std::string text = read_file(fixtures / "scenarios" / scenario);
    const auto replace = [&](const std::string& from, const std::string& to) {
      const std::size_t at = text.find(from);
      ASSERT_NE(at, std::string::npos) << from;
      text.replace(at, from.size(), to);
    };
    replace("../models", (fixtures / "models").string());
    const std::size_t golden = text.find("\ngolden:");
    text.erase(golden, text.find('\n', golden + 1) - golden);
    const std::size_t expectations = text.find("\nexpect:");
    text.erase(expectations);
    const std::size_t at = text.find("\nduration:");
    text.replace(at, text.find('\n', at + 1) - at, "\nduration: " + duration);
    replace("- name: " + old + "\n        library: " + old + "Controller",
            "- name: " + name + "\n        library: " + library.string() + "\n        options: " + options);
    return write(name + ".yaml", text);
  }
  fs::path stoop(const fs::path& library, const std::string& options) const {
    return with_controller("sr1_minimum.yaml", "SR1Minimum", library, "Stoop", "'" + options + "'", "0.6");
  }

  std::map<std::string, std::vector<double>> recorded(const fs::path& library) const {
    const Outcome outcome = rehearse({"record", stoop(library, "0.1").string(), "-o", "run.mcap"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const auto trace = Trace::load(folder() / "run.mcap");
    std::map<std::string, std::vector<double>> values;
    if (!trace) return values;
    for (const auto& [name, place] : trace->series())
      if (name.starts_with("SR1/")) values[name] = trace->values(name);
    return values;
  }
};

TEST_F(Languages, GiveTheSameBits) {
  const auto in_cpp = recorded(STOOP_CPP);
  ASSERT_GT(in_cpp.size(), 200u);
  ASSERT_TRUE(in_cpp.contains("SR1/Stoop/variable/phase"));
  EXPECT_LT(in_cpp.at("SR1/RLEG_KNEE/q").back(), 1.0);
  EXPECT_GT(in_cpp.at("SR1/RLEG_KNEE/q").back(), 0.2) << "it stoops";
  const auto bits = [](const std::vector<double>& values) {
    return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
  };
  std::vector<fs::path> others{STOOP_C, STOOP_C_1};
  if (*STOOP_RUST) others.emplace_back(STOOP_RUST);
  if (*STOOP_PYTHON) others.emplace_back(STOOP_PYTHON);
  for (const fs::path& other : others) {
    const auto values = recorded(other);
    EXPECT_EQ(values.size(), in_cpp.size()) << other;
    for (const auto& [name, expected] : in_cpp) {
      ASSERT_TRUE(values.contains(name)) << name;
      EXPECT_TRUE(bits(values.at(name)) == bits(expected)) << other << " differs in " << name;
    }
  }
}

TEST_F(Languages, AControllerInCIsReplayedWithoutPhysics) {
  ASSERT_EQ(rehearse({"record", stoop(STOOP_C, "0.1").string(), "-o", "run.mcap"}).status, 0);
  const Outcome replayed = rehearse({"replay", "run.mcap"});
  EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
  const Outcome other = rehearse({"replay", "run.mcap", "--controller", std::string("Stoop=") + STOOP_CPP});
  EXPECT_EQ(other.status, 0) << other.out << other.err;
}

/// Threads of each language take turns: one hash of all commands in all runs, and in a replay.
TEST_F(Languages, HaveThreadsThatTakeTurns) {
  if (is_sanitized) GTEST_SKIP() << why_free;
  for (const fs::path library : {PLANNER_CPP, PLANNER_RUST, PLANNER_PYTHON}) {
    if (library.empty()) continue;
    const fs::path scenario = write("threads.yaml",
                                    "rehearse: 1\nname: threads\nduration: 0.1\nbodies:\n"
                                    "  - name: Pendulum\n    model: " +
                                        (fixtures / "models/pendulum.urdf").string() +
                                        "\n    joints: {hinge: 20 deg}\n    controllers:\n"
                                        "      - {name: Planner, library: " +
                                        library.string() + "}\n");
    std::vector<std::vector<std::uint64_t>> hashes;
    for (const char* file : {"run.mcap", "again.mcap", "once_more.mcap"}) {
      const Outcome outcome = rehearse({"record", scenario.string(), "-o", file});
      EXPECT_EQ(outcome.status, 0) << outcome.err;
      EXPECT_THAT(outcome.err, ::testing::Not(HasSubstr("thread"))) << library;
      const auto trace = Trace::load(folder() / file);
      ASSERT_TRUE(trace) << library;
      hashes.push_back(trace->integers("output_hash"));
      EXPECT_LT(trace->values("Pendulum/Planner/output/hinge/u").back(), -1.0) << "a plan has come";
    }
    EXPECT_EQ(hashes[0], hashes[1]) << library;
    EXPECT_EQ(hashes[0], hashes[2]) << library;
    const Outcome replayed = rehearse({"replay", "run.mcap"});
    EXPECT_EQ(replayed.status, 0) << library << replayed.out << replayed.err;
    if (library == PLANNER_CPP) continue;  // audit/zoo_test.cpp has those of C++
    const Outcome audit = rehearse({"audit", "run.mcap"});
    EXPECT_EQ(audit.status, 0) << library << audit.out;
    EXPECT_THAT(audit.out, HasSubstr("take turns")) << library;
  }
}

TEST_F(Languages, EachFunctionOfTheHeaderAnswersAsItSays) {
  const fs::path scenario = with_controller("room.yaml", "Scout", EVERYTHING, "Everything", "one two", "0.4");
  const Outcome outcome = rehearse({"record", scenario.string(), "-o", "run.mcap"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto trace = Trace::load(folder() / "run.mcap");
  ASSERT_TRUE(trace);
  std::string said;
  for (const msg::Event& event : trace->events()) said += event.text + "\n";
  EXPECT_EQ(said, "hello from C\nstopped\n");
}

TEST_F(Languages, AnAuditSeesTheLastCallOfControl) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "calls are audited in builds without sanitizers";
#endif
  const Outcome outcome =
      rehearse({"audit", "--realtime", with_controller("room.yaml", "Scout", NAPS, "Naps", "none", "0.05").string()});
  EXPECT_THAT(outcome.out, HasSubstr("Scout/Naps isn't real-time safe: system call by usleep in control() (naps.c:15)"))
      << outcome.err;
}

TEST_F(Languages, TheManualHasEachFunctionOfTheHeader) {
  const std::string header = read_file(fs::path(SOURCE_DIR) / "controllers/include/rehearse/controller.h");
  const std::string manual = read_file(fs::path(SOURCE_DIR) / "tools/site/pages/reference/controller_c.md");
  const std::regex declared("REHEARSE_EXPORT [a-z ]+\\*? ?(rehearse_[a-z_]+)\\(");
  std::size_t count = 0;
  for (std::sregex_iterator found(header.begin(), header.end(), declared), end; found != end; ++found, ++count)
    EXPECT_THAT(manual, HasSubstr("`" + (*found)[1].str()));
  EXPECT_EQ(count, 31u);
}

/// The declarations of a C header, without comments, spaces and lines of the preprocessor.
std::vector<std::string> declarations_in(const fs::path& file) {
  std::string text = read_file(file);
  text = std::regex_replace(text, std::regex("/\\*[^*]*\\*+([^/*][^*]*\\*+)*/"), "");
  text = std::regex_replace(text, std::regex("#[^\n]*\n"), "\n");
  text = std::regex_replace(text, std::regex("\\s+"), "");
  std::vector<std::string> found;
  std::istringstream all(text);
  for (std::string one; std::getline(all, one, ';');) found.push_back(one);
  return found;
}

TEST_F(Languages, TheHeaderStillHasAllThatVersion1Has) {
  const auto now = declarations_in(fs::path(SOURCE_DIR) / "controllers/include/rehearse/controller.h");
  const auto frozen = declarations_in(fs::path(SOURCE_DIR) / "tests/languages/version_1/rehearse/controller.h");
  EXPECT_GT(frozen.size(), 40u);
  EXPECT_THAT(now, ::testing::IsSupersetOf(frozen));
}

TEST_F(Languages, OfAnUnknownVersionIsRefused) {
  const auto refusal = [&](const char* library) {
    return rehearse({"record", with_controller("room.yaml", "Scout", library, "Everything", "a", "0.1").string()}).err;
  };
  EXPECT_THAT(refusal(EVERYTHING_2),
              HasSubstr("'everything_2.so' can't be used: its rehearse_controller states version "
                        "2; this Rehearse knows version 1"));
  EXPECT_THAT(refusal(INCOMPLETE), HasSubstr("its rehearse_controller has no control"));
}

TEST_F(Languages, AWrongAnswerInCIsAFailureWithItsSentence) {
  const fs::path scenario = with_controller("room.yaml", "Scout", EVERYTHING, "Everything", "three", "0.1");
  const Outcome outcome = rehearse({"record", scenario.string()}, no_leak_check_);
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.out + outcome.err, ContainsRegex("everything.c:[0-9]+: strcmp\\(rehearse_options"));
}

TEST_F(Languages, AFailureInRustHasItsTickAndItsLine) {
  if (!*STOOP_RUST) GTEST_SKIP() << "cargo isn't installed";
  const auto run = [&](const std::string& options) {
    return rehearse({"record", stoop(STOOP_RUST, options).string(), "-o", "run.mcap"}, no_leak_check_);
  };
  const Outcome failed = run("fail");
  EXPECT_EQ(failed.status, 3);
  EXPECT_THAT(failed.err,
              HasSubstr("controller 'SR1/Stoop' returned -1: the battery is empty in control() at tick 50"));
  const Outcome panicked = run("panic");
  EXPECT_EQ(panicked.status, 3);
  EXPECT_THAT(panicked.err,
              ContainsRegex("controller 'SR1/Stoop' returned -1: panicked at .*lib.rs:[0-9]+:[0-9]+.*index "
                            "out of bounds.* in control\\(\\) at tick 50|index out of bounds.*lib.rs:"));
  const auto trace = Trace::load(folder() / "run.mcap");
  ASSERT_TRUE(trace);
  EXPECT_EQ(trace->ticks(), 51);
  const Outcome refused = run("joint");
  EXPECT_THAT(refused.out + refused.err, HasSubstr("the robot has no joint 'KNEE'; it has RLEG_HIP_R, "));
}

}  // namespace
}  // namespace rehearse::test
