// The instructions of control(): ways to take long without a call, which an audit names with tick and function, and
// ways that look alike and have equal counts in each tick.
#include "audit/audit/instruction_profile.h"
#include "audited.h"
#include "support/printed_by_name.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <regex>

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

struct Length {
  const char* name;
  bool is_long = false;
};

const Length lengths[] = {
    {"input_loop", true}, {"busy_wait", true},  {"quadratic_search", true}, {"many_casts", true}, {"many_sines", true},
    {"good_denormals"},   {"good_first_touch"}, {"good_deep_stack"},        {"good_cold_call"},
};

class Instructions : public Audited, public ::testing::WithParamInterface<Length> {};

TEST_P(Instructions, AreNamedWhereTheyAreMany) {
  const Length& length = GetParam();
  const Outcome outcome = rehearse({"audit", scenario("lengthy", length.name).string(), "--instructions", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  const nlohmann::json report = outcome.json(), counts = report["controllers"][0]["instructions"];
  ASSERT_EQ(counts["calls"].size(), 200u);
  const std::uint64_t most = counts["most"]["instructions"], median = counts["median"];
  EXPECT_GT(median, 10u);
  if (!length.is_long) {
    for (std::size_t i = 1; i < counts["calls"].size(); ++i)
      EXPECT_EQ(counts["calls"][i]["instructions"], median) << "call " << i;
    EXPECT_THAT(report["verdict"], HasSubstr(" instructions in each tick"));
    return;
  }
  EXPECT_EQ(counts["most"]["tick"], 150);
  EXPECT_GT(most, 10 * median);
  EXPECT_THAT(counts["lines"][0]["function"], HasSubstr(fmt::format("Lengthy::{}()", length.name)));
  EXPECT_THAT(counts["lines"][0]["line"], StartsWith("lengthy.cpp:"));
  EXPECT_THAT(report["verdict"], HasSubstr(" instructions, at tick 150, and "));
  EXPECT_THAT(report["verdict"], HasSubstr(fmt::format("Lengthy::{}() (lengthy.cpp:", length.name)));
}

INSTANTIATE_TEST_SUITE_P(Of, Instructions, ::testing::ValuesIn(lengths), by_name);

/// Equal in each run, in another folder and with another environment.
TEST_F(Audited, CountsEqualInstructionsInEachRun) {
  done({"record", scenario("lengthy", "input_loop").string(), "-o", "run.mcap"});
  const Outcome first = rehearse({"audit", "run.mcap", "--instructions", "--json"});
  ASSERT_EQ(first.status, 0) << first.err;
  fs::create_directory(folder() / "another_folder_for_temporary_files");
  for (int run = 0; run < 2; ++run) {
    const std::string temporary = (folder() / "another_folder_for_temporary_files").string();
    const Outcome again =
        rehearse({"replay", "run.mcap", "--instructions", "--json"},
                 fmt::format("TMPDIR={} MORE={}", quoted(temporary), std::string(run * 1000 + 1, 'x')));
    EXPECT_EQ(first.json()["controllers"][0]["instructions"], again.json()["controllers"][0]["instructions"]) << run;
  }
}

TEST_F(Audited, CountsInstructionsWithoutOptionsThatAskForSomethingElse) {
  done({"record", scenario("lengthy", "busy_wait").string(), "-o", "run.mcap"});
  const Outcome outcome = rehearse({"replay", "run.mcap", "--instructions", "--deadline", "1"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--instructions goes without --deadline"));
}

TEST_F(Audited, ListsTheLinesWithMostInstructions) {
  const Outcome outcome = rehearse({"audit", scenario("lengthy", "busy_wait").string(), "--instructions"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, StartsWith("control() of Pendulum/Zoo takes at most "));
  EXPECT_THAT(outcome.out, ::testing::ContainsRegex("instructions at tick 150 +line +function"));
  EXPECT_THAT(outcome.out, ::testing::ContainsRegex("lengthy.cpp:[0-9]+ +.*Lengthy::busy_wait"));
}

/// Counts that are kept beside a golden, and compared with new ones.
class KeptInstructions : public Audited {
 protected:
  void SetUp() override {
    const fs::path file = scenario("lengthy", "input_loop");
    write("zoo.yaml", read_file(file) + "golden: Zoo.Lengthy\n");
    fs::create_directory(folder() / "golden");
    ASSERT_EQ(rehearse({"check", "zoo.yaml"}, "REHEARSE_GOLDEN=new").status, 0);
  }
  Outcome check(const std::string& environment = "") const {
    return rehearse({"check", "zoo.yaml", "--instructions"}, environment);
  }
  void keep() const {
    const Outcome outcome = check("REHEARSE_GOLDEN=new");
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out,
                StartsWith("Zoo.Lengthy: kept in golden/Zoo.Lengthy.instructions: control() of Pendulum/Zoo takes "));
  }
  std::string kept() const { return read_file(folder() / "golden/Zoo.Lengthy.instructions"); }
  /// Replaces what the expression finds, which must be there.
  void change(const std::string& expression, const std::string& by) const {
    const std::string before = kept();
    const std::string after = std::regex_replace(before, std::regex(expression), by);
    ASSERT_NE(before, after) << expression;
    write("golden/Zoo.Lengthy.instructions", after);
  }
};

TEST_F(KeptInstructions, AreEqualInTheNextCheck) {
  EXPECT_EQ(check().status, 2);
  EXPECT_THAT(check().err, StartsWith("error: no counts of instructions are kept beside the goldens"));
  keep();
  const Outcome outcome = check();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "Zoo.Lengthy: control() of Pendulum/Zoo takes the expected instructions in 199 ticks\n");
  const std::string before = kept();
  EXPECT_EQ(check("REHEARSE_GOLDEN=accept").status, 0);
  EXPECT_EQ(kept(), before);
  EXPECT_EQ(check("REHEARSE_GOLDEN=accept CI=true").status, 2);
}

TEST_F(KeptInstructions, ThatGrewAreNamedWithTickAndLine) {
  keep();
  change("\\[150, [0-9]+\\]", "[150, 1204]");
  const Outcome outcome = check();
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_THAT(outcome.out,
              ::testing::ContainsRegex(
                  "Zoo.Lengthy: control\\(\\) of Pendulum/Zoo takes [0-9,]+ instructions at tick 150, 1,204 "
                  "expected; [0-9]+ % of them in lengthy.cpp:[0-9]+, Lengthy::input_loop\\(\\); over 2 % more "
                  "in 1 of 199 ticks, from tick 150 on\n"));
  const nlohmann::json checked = rehearse({"check", "zoo.yaml", "--instructions", "--json"}).json();
  EXPECT_EQ(checked["within"], false);
  EXPECT_EQ(checked["recordings"][0]["controllers"][0]["first"]["tick"], 150);
  EXPECT_EQ(checked["recordings"][0]["controllers"][0]["worst"]["expected"], 1204);
}

TEST_F(KeptInstructions, ThatAreFewerOrTwoPercentMorePass) {
  keep();
  change("\\[150, ([0-9]+)\\]", "[150, 9$1]");
  EXPECT_THAT(check().out,
              ::testing::ContainsRegex(": control\\(\\) of Pendulum/Zoo takes [0-9.]+ % fewer instructions "
                                       "than expected in 199 ticks\n"));
  EXPECT_EQ(check().status, 0);
}

TEST_F(KeptInstructions, OfAnotherCompilerOrRecordingAreNotCompared) {
  keep();
  const std::string before = kept();
  change("\"GNU C\\+\\+", "\"Another C++");
  EXPECT_EQ(check().status, 2);
  EXPECT_THAT(check().out,
              HasSubstr("aren't compared: their library was compiled with 'Another', the present one with 'GNU'\n"));
  write("golden/Zoo.Lengthy.instructions", before);
  change("(\"compilers\": \"[^\"]*)", "$1 -O7");
  EXPECT_THAT(check().out, HasSubstr("compiled with '-O7', the present one without '-O7'\n"));
  write("golden/Zoo.Lengthy.instructions", before);
  change("(\"compilers\": )\"[^\"]*", "$1\"");
  EXPECT_THAT(check().out, HasSubstr(": their library has no debug information, which names the compiler"));
  write("golden/Zoo.Lengthy.instructions", before);
  change("\"recording\": \"[0-9a-f]+\"", "\"recording\": \"0\"");
  EXPECT_THAT(check().out, HasSubstr("they are kept of another recording: the golden was accepted anew"));
  change("glibc [0-9.]+", "glibc 1");
  change("\"recording\": \"0\"", before.substr(before.find("\"recording\""), 31));
  EXPECT_THAT(check().out, HasSubstr("they are kept of glibc 1, and this is glibc "));
}

TEST_F(KeptInstructions, ThatCanNotBeReadAreAnErrorWithTheirFile) {
  for (const char* text : {"", "[1, 2]", "{\"rehearse_instructions\": 1}", "{\"rehearse_instructions\": 2}"}) {
    write("golden/Zoo.Lengthy.instructions", text);
    const Outcome outcome = check();
    EXPECT_EQ(outcome.status, 2) << text;
    EXPECT_THAT(outcome.out, StartsWith("Zoo.Lengthy: golden/Zoo.Lengthy.instructions: error: ")) << text;
  }
}

TEST_F(Audited, CountsNoInstructionsOfAControllerThatFails) {
  const Outcome outcome = rehearse({"audit", scenario("bad_manners", "throw").string(), "--instructions"});
  EXPECT_EQ(outcome.status, 3) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("failed: "));
  EXPECT_THAT(outcome.out, HasSubstr("no gait for this slope"));
}

class Profile : public Audited {
 protected:
  Result<std::map<std::string, InstructionCounts>> read(const std::string& text) const {
    return read_instruction_profiles(write("profile", text), {{"Arm/Hold", "/c/hold.so"}});
  }
  static std::string call(int tick, const std::string& costs) {
    return fmt::format("desc: Trigger: Client Request: {}\n\npositions: instr line\nevents: Ir\n{}\ntotals: 1\n",
                       profile_title("Arm/Hold", tick), costs);
  }
};

/// Costs of a call of another library belong to the calling line, and are counted once in the sum.
TEST_F(Profile, IsReadWithCallsAndWithoutTheHost) {
  const auto counts = read(
      "version: 1\ncreator: c\n" +
      call(
          0,
          "ob=(1) /c/hold.so\nfl=(1) hold.cpp\nfn=(1) Hold::control()\n0x10 5 7\ncob=(2) /lib/libm.so.6\n"
          "cfi=(2) sin.c\ncfn=(2) sin\ncalls=1 0x80 0\n0x14 6 30\n\nob=(2)\nfl=(2)\nfn=(2)\n0x80 0 30\n\n"
          "ob=(3) /h/rehearse\nfn=(3) rehearse::ControllerHost::control()::{lambda()#1}::operator()() const\n0x1 1 9") +
      call(1, "ob=(1)\nfl=(1)\nfn=(1)\n0x10 5 8"));
  ASSERT_TRUE(counts.ok()) << to_string(counts.errors());
  const InstructionCounts& hold = counts->at("Arm/Hold");
  ASSERT_EQ(hold.calls.size(), 2u);
  EXPECT_EQ(hold.calls[0].instructions, 37u);
  EXPECT_EQ(hold.calls[1].instructions, 8u);
  EXPECT_EQ(hold.most.tick, 1) << "tick 0 may take its time";
  EXPECT_EQ(hold.median(), 8u);
  ASSERT_EQ(hold.lines.size(), 1u);
  EXPECT_EQ(hold.lines[0].instructions, 8u);
}

TEST_F(Profile, OfAnotherFormIsRefusedWithItsLine) {
  for (const char* wrong : {"0x10 5", "0x10 five 7", "fn=control()"}) {
    const auto counts = read(call(0, "ob=(1) /c/hold.so\nfn=(1) f\n" + std::string(wrong)));
    ASSERT_FALSE(counts.ok()) << wrong;
    EXPECT_EQ(counts.errors()[0].line, 7) << wrong;
    EXPECT_THAT(counts.errors()[0].message, HasSubstr(wrong));
  }
  EXPECT_FALSE(read_instruction_profiles(folder() / "none", {}).ok());
}

}  // namespace
}  // namespace rehearse::test
