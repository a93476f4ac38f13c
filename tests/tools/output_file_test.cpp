// -o -: a verb's file on standard output.
#include <gmock/gmock.h>

#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A verb with the arguments before -o.
struct Writing {
  std::string verb;
  std::vector<std::string> arguments;
};

class OutputFile : public Command, public ::testing::WithParamInterface<Writing> {
 protected:
  OutputFile() { done({"record", pendulum(MISBEHAVING, "nothing 0").string(), "-o", "run.mcap"}); }

  Outcome write_to(const std::string& file, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{GetParam().verb};
    for (const std::vector<std::string>& list : {GetParam().arguments, {"-o", file}, more})
      words.insert(words.end(), list.begin(), list.end());
    return rehearse(words);
  }
};

TEST_P(OutputFile, OfAMinusIsPrintedOnStdoutAndSentencesOnStderr) {
  const Outcome named = write_to("named");
  ASSERT_EQ(named.status, 0) << named.err;
  const std::string temporary = (folder() / "temporary").string();
  fs::create_directory(temporary);
  setenv("TMPDIR", temporary.c_str(), 1);
  const Outcome printed = write_to("-");
  unsetenv("TMPDIR");
  EXPECT_EQ(printed.status, 0) << printed.err;
  EXPECT_EQ(printed.out, read_file(folder() / "named"));
  EXPECT_NE(printed.err, "") << "the verb's sentences";
  EXPECT_THAT(printed.err, Not(HasSubstr(temporary)));
  EXPECT_FALSE(exists("-"));
  EXPECT_TRUE(fs::is_empty(temporary));
}

INSTANTIATE_TEST_SUITE_P(Verbs, OutputFile,
                         ::testing::Values(Writing{"filter", {"run.mcap"}}, Writing{"merge", {"run.mcap"}},
                                           Writing{"recover", {"run.mcap"}},
                                           Writing{"export", {"run.mcap", "--joined"}},
                                           Writing{"render", {"pendulum.yaml"}}),
                         [](const auto& verb) { return verb.param.verb; });

class OutputFileOfAMinus : public Command {};

TEST_F(OutputFileOfAMinus, IsRefusedBesideJson) {
  done({"record", pendulum(MISBEHAVING, "nothing 0").string(), "-o", "run.mcap"});
  const Outcome outcome = rehearse({"filter", "run.mcap", "-o", "-", "--json"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("-o - with --json: both are printed on stdout"));
}

TEST_F(OutputFileOfAMinus, IsRefusedForAFolderOfTables) {
  done({"record", pendulum(MISBEHAVING, "nothing 0").string(), "-o", "run.mcap"});
  const Outcome outcome = rehearse({"export", "run.mcap", "-o", "-"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("-o - is for one table: --joined (name a folder)"));
}

TEST_F(OutputFileOfAMinus, ReportsAFullDisk) {
  done({"record", pendulum(MISBEHAVING, "nothing 0").string(), "-o", "run.mcap"});
  const Outcome outcome = run("/bin/sh", {"-c", "\"$0\" filter run.mcap -o - > /dev/full", command.string()});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("can't write to stdout: No space left on device"));
}

}  // namespace
}  // namespace rehearse::test
