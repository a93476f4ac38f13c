// rehearse doc, and help.
#include <gmock/gmock.h>

#include <sstream>

#include "command.h"

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class Doc : public Command {};

TEST_F(Doc, ListsTopicsThatAreThere) {
  std::istringstream lines(done({"doc"}).out);
  int topics = 0;
  for (std::string line; std::getline(lines, line) && !line.empty(); ++topics)
    EXPECT_THAT(done({"doc", line.substr(0, line.find(' '))}).out, StartsWith("# ")) << line;
  EXPECT_GE(topics, 8);
}

TEST_F(Doc, AnUnknownTopicIsNamed) {
  const Outcome outcome = rehearse({"doc", "love"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.err, "error: there is no topic 'love' (rehearse doc lists the topics)\n");
}

TEST_F(Doc, PutsTheKeysOfTheParserIntoPages) {
  const std::string solver = done({"doc", "--keys", "scenario.solver"}).out;
  EXPECT_THAT(
      solver,
      HasSubstr("| `erp` | share of a joint's error that is corrected in a step | number from 0 to 1 | `0.4` |\n"));
  EXPECT_THAT(done({"doc", "scenarios"}).out, HasSubstr(solver));
  for (const char* topic :
       {"scenarios", "bodies", "inputs", "noise", "tolerances", "expectations", "variations", "maps"}) {
    const std::string page = done({"doc", topic}).out;
    EXPECT_THAT(page, HasSubstr("| key | what | values | default |")) << topic;
    EXPECT_THAT(page, Not(HasSubstr("<<made:"))) << topic;
    EXPECT_THAT(page, Not(HasSubstr("there is no form"))) << topic;
  }
}

TEST_F(Doc, AnUnknownFormIsNamed) {
  const Outcome outcome = rehearse({"doc", "--keys", "scenario.love"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.err, "error: there is no form 'scenario.love' (expected SCHEMA.FORM, as scenario.solver)\n");
}

TEST_F(Doc, HelpOfAVerbIsItsHelp) {
  for (const char* verb : {"record", "audit", "golden"})
    EXPECT_EQ(done({"help", verb}).out, done({verb, "--help"}).out);
  EXPECT_THAT(done({"--help"}).out, HasSubstr("--version"));
}

TEST_F(Doc, LinesOfHelpHaveAtMost100Columns) {
  std::istringstream verbs(done({"--help"}).out);
  for (std::string line; std::getline(verbs, line);) {
    EXPECT_LE(line.size(), 110u) << line;
    if (!line.starts_with("  ") || line[2] == ' ') continue;
    const std::string verb = line.substr(2, line.find(' ', 2) - 2);
    std::istringstream help(done({verb, "--help"}).out);
    for (std::string text; std::getline(help, text) && text != "Example:";) EXPECT_LE(text.size(), 100u) << text;
  }
}

}  // namespace
}  // namespace rehearse::test
