// The command line itself: help, versions, typing errors.
#include "command.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <utility>

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::vector<std::string> verbs{"record", "check", "replay", "diff", "golden", "info", "inspect", "render"};

class Usage : public Command {};

/// Refused with one line of that text; nothing on stdout and nothing written.
class RefusedUsage : public Command,
                     public ::testing::WithParamInterface<std::pair<std::vector<std::string>, std::string>> {};

TEST_F(Usage, HelpListsEachVerbWithALine) {
  const Outcome outcome = done({"--help"});
  for (const std::string& verb : verbs) EXPECT_THAT(outcome.out, HasSubstr("\n  " + verb + " "));
  EXPECT_THAT(outcome.out, HasSubstr("Exit status: 0 "));
}

TEST_F(Usage, HelpGroupsTheVerbs) {
  const std::string help = done({"--help"}).out;
  std::size_t at = 0;
  for (const char* words :
       {"\nEvery day:\n  new ", "\n  check ", "\n  golden ", "\n  record ", "\n  replay ", "\n  step ", "\n  report ",
        "\n\nCampaigns and audits:\n  sweep ", "\n  audit ", "\n\nRecordings and logs as files:\n  info ", "\n  cat ",
        "\n  diff ", "\n  export ", "\n\nModels and projects:\n  inspect "}) {
    at = help.find(words, at);
    ASSERT_NE(at, std::string::npos) << words << help;
  }
}

TEST_F(Usage, EachVerbHelpsWithAnExample) {
  for (const std::string& verb : verbs) {
    const Outcome outcome = done({verb, "--help"});
    EXPECT_THAT(outcome.out, HasSubstr("Usage: rehearse " + verb));
    EXPECT_THAT(outcome.out, HasSubstr("Example:\n  rehearse " + verb));
  }
}

TEST_F(Usage, SaysItsVersion) { EXPECT_EQ(done({"--version"}).out, "rehearse " REHEARSE_VERSION "\n"); }

TEST_F(Usage, TheProgramBehindItIsNotStartedByHand) {
  const Outcome outcome = run(REHEARSE_SIMULATE, {});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, StartsWith("error: rehearse-simulate is a part of rehearse"));
  EXPECT_THAT(run(REHEARSE_READ, {"check"}).err, StartsWith("error: rehearse-read is a part of rehearse"));
}

TEST_F(Usage, WithoutTheProgramBehindItSaysWhichOneIsMissing) {
  fs::create_directories(folder() / "bin");
  fs::copy_file(command, folder() / "bin/rehearse");
  const std::string programs = (fs::canonical(folder()) / "libexec/rehearse/rehearse-").string();
  for (const auto& [verb, program] :
       {std::pair("info", "read"), std::pair("check", "simulate"), std::pair("map", "logs"),
        std::pair("sweep", "campaigns"), std::pair("audit", "audit"), std::pair("import", "choreonoid"),
        std::pair("fuzz", "fuzz"), std::pair("fit", "fitting")}) {
    const Outcome outcome = run(folder() / "bin/rehearse", {verb, "a"});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.err, "error: can't start " + programs + program +
                               ": No such file or directory (in a checkout, tools/build release rehearse-" + program +
                               " builds it)\n");
  }
}

TEST_F(Usage, ADemoHasNoProgramsOfWingsAndSaysHowTheyAreBuilt) {
  fs::create_directories(folder() / "bin");
  fs::create_directories(folder() / "libexec/rehearse");
  fs::copy_file(command, folder() / "bin/rehearse");
  fs::copy_file(REHEARSE_READ, folder() / "libexec/rehearse/rehearse-read");  // its libraries are those of the build
  const fs::path reader = folder() / "bin/rehearse";
  EXPECT_EQ(run(reader, {"doctor", "none.mcap"}).status, 2);  // without logs
  const Outcome log = run(reader, {"replay", "a.mcap", "--model", "a.urdf", "--map", "a.yaml", "--controller", "A"});
  EXPECT_EQ(log.status, 2);
  EXPECT_THAT(log.err, HasSubstr("tools/build release rehearse-logs builds it"));
}

TEST_F(Usage, HelpOfAVerbIsThatOfItsOption) {
  for (const char* verb : {"info", "check", "step"}) EXPECT_EQ(done({"help", verb}).out, done({verb, "--help"}).out);
  EXPECT_EQ(done({"help"}).out, done({"--help"}).out);
}

TEST_P(RefusedUsage, WithOneLineAndNothingWritten) {
  const auto& [arguments, message] = GetParam();
  const Outcome outcome = rehearse(arguments);
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, HasSubstr(message));
  EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
  EXPECT_TRUE(is_empty());
}

const std::string box = box_scenario.string();

using Case = std::pair<std::vector<std::string>, const char*>;
INSTANTIATE_TEST_SUITE_P(
    Of, RefusedUsage,
    ::testing::Values(
        Case{{}, "error: no verb given (rehearse --help lists all verbs)"},
        Case{{"recrd"}, "error: there is no verb 'recrd' (did you mean record? rehearse --help lists all verbs)"},
        Case{{"info", "--ful"},
             "error: rehearse info: there is no option --ful (did you mean --full? see rehearse info"},
        Case{{"--verbose"}, "error: there is no option --verbose before the verb (see rehearse --help)"},
        Case{{"--hepl"}, "error: there is no option --hepl before the verb (did you mean --help? see rehearse --help)"},
        Case{{"record"}, "error: rehearse record: SCENARIO is required, or --model URDF (see rehearse record --help)"},
        Case{{"record", box, "--sed", "1"},
             "error: rehearse record: there is no option --sed (did you mean --seed or --set? see rehearse record "
             "--help)"},
        Case{{"record", "--sed=1"},
             "there is no option --sed (did you mean --seed or --set? see rehearse record --help)"},
        Case{{"record", box, "--unheard"},
             "rehearse record: there is no option --unheard (see rehearse record --help)"},
        Case{{"diff", box, box, box}, "error: rehearse diff: The following argument was not expected: "},
        Case{{"record", box, "--seed"}, "error: rehearse record: --seed: 1 required NUMBER missing"},
        Case{{"record", box, "--seed", "-1"}, "--seed: '-1' is not a whole number from 0 to 4294967295"},
        Case{{"record", box, "--seed", "1.5"}, "--seed: '1.5' is not a whole number"},
        Case{{"record", box, "--duration", "long"}, "--duration: 'long' is not a number from 0 to 86400"},
        Case{{"record", box, "--duration", "1e9"}, "--duration: '1e9' is not a number from 0 to 86400"},
        Case{{"record", box, "--duration", "nan"}, "--duration: 'nan' is not a number from 0 to 86400"},
        Case{{"record", box, "--duration", "0"}, "error: --duration 0 is no tick"},
        Case{{"record", box, "--controller", "Walker"}, "--controller: 'Walker' is not NAME=LIB"},
        Case{{"record", box, "--controller", "=lib.so"}, "--controller: '=lib.so' is not NAME=LIB"},
        Case{{"record", box, "--controller", "A=b", "--controller", "A=c"}, "--controller: 'A' is given twice"},
        Case{{"record", box, "--call-limit", "0"}, "--call-limit: '0' is not a number from 0.01 to 86400"},
        Case{{"record", box, "-o", "/nowhere/a.mcap"}, "/nowhere/a.mcap: error: can't create the trace"},
        Case{{"record", box, "-o", "/"}, "error: can't write /: it is a directory"},
        Case{{"record", box, "-o", box}, "it exists and is no trace (name another file, or remove it first)"},
        Case{{"record", "/"}, "/: error: it is a directory"},
        Case{{"record", "nowhere.yaml"}, "nowhere.yaml: error: there is no such file"},
        Case{{"replay", "nowhere.mcap"}, "nowhere.mcap: error: can't read the trace: No such file or directory"},
        Case{{"replay", "/"}, "/: error: can't read the trace: it is a directory"},
        Case{{"replay", box}, "drop_box.yaml: error: not an MCAP file"},
        Case{{"check", box, "--level", "open"}, "--level: 'open' is not controller, plant or closed"},
        Case{{"check", box}, "drop_box.yaml: error: the scenario names no golden to compare with"},
        Case{{"check"},
             "error: this folder is of no project: no folder above it has a folder 'golden', a CMakeLists.txt, a "
             "pyproject.toml or a pytest.ini"},
        Case{{"check", box, box, "--golden", "a.mcap"}, "error: --golden compares one scenario"},
        Case{{"check", box, "--golden", "nowhere.mcap"}, "nowhere.mcap: error: can't read the trace"},
        Case{{"diff", box}, "error: rehearse diff: B is required"},
        Case{{"diff", box, box}, "drop_box.yaml: error: not an MCAP file"},
        Case{{"golden"}, "error: rehearse golden: A subcommand is required"},
        Case{{"golden", "accept"},
             "error: no run is named (NAME, or --all; rehearse golden review shows the runs that wait)"},
        Case{{"golden", "accept", "A.B", "--all"}, "error: names are given, and --all (one of them will do)"},
        Case{{"golden", "accept", "A.B", "--from", "later"}, "--from: 'later' is no time"},
        Case{{"golden", "accept", "A.B", "--form", "2"},
             "error: rehearse golden accept: there is no option --form (did you mean --from? see rehearse golden "
             "accept"},
        Case{{"golden", "acept"},
             "error: rehearse golden: there is no acept (did you mean accept? see rehearse golden"},
        Case{{"golden", "reject"}, "error: no run is named"},
        Case{{"golden", "review"},
             "error: ./ belongs to no project: no folder above it has a folder 'golden', a CMakeLists.txt, a "
             "pyproject.toml or a pytest.ini"},
        Case{{"golden", "prune"},
             "error: ./ belongs to no project: no folder above it has a folder 'golden', a CMakeLists.txt, a "
             "pyproject.toml or a pytest.ini"},
        Case{{"golden", "list"},
             "error: ./ belongs to no project: no folder above it has a folder 'golden', a CMakeLists.txt, a "
             "pyproject.toml or a pytest.ini"},
        Case{{"info", box}, "drop_box.yaml: error: not an MCAP file"},
        Case{{"info", "nowhere.mcap"}, "nowhere.mcap: error: can't read the trace"},
        Case{{"inspect", "nowhere.urdf"}, "nowhere.urdf: error: "}, Case{{"inspect", "/"}, "/: error: "},
        Case{{"inspect", box, "--default-mass", "0"}, "--default-mass: '0' is not a number from 1e-09 to 1000000000"},
        Case{{"render", box}, "error: rehearse render: --output is required"},
        Case{{"render", box, "-o", "a.png", "--eye", "1,2"}, "--eye: '1,2' is not x,y,z"},
        Case{{"render", box, "-o", "a.png", "--eye", "1,2,c"}, "--eye: 'c' is not a number"},
        Case{{"render", box, "-o", "a.png", "--width", "0"}, "--width: '0' is not a whole number from 1 to 2730"},
        Case{{"render", box, "-o", "a.png", "--eye", "1,1,1", "--target", "1,1,1"}, "--eye and --target are the same"},
        Case{{"render", box, "-o", box}, "it exists and is no PNG picture"},
        Case{{"render", "nowhere.yaml", "-o", "a.png"}, "nowhere.yaml: error: there is no such file"}));

}  // namespace
}  // namespace rehearse::test
