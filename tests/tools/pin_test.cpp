// A process is pinned in any environment, and its recordings state it.
#include "command.h"

#include <gmock/gmock.h>

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Nothing of how the tests themselves were started comes through.
const std::string unpinned = "env -u GLIBC_TUNABLES -u GALLIUM_OVERRIDE_CPU_CAPS -u LP_NUM_THREADS -u REHEARSE_PIN ";
const std::string pinned_from_outside =
    "env GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX GALLIUM_OVERRIDE_CPU_CAPS=sse4.1 LP_NUM_THREADS=1 ";
const fs::path simulator = REHEARSE_SIMULATE, reader = REHEARSE_READ;

bool can_run(const std::string& line) { return std::system((line + " > /dev/null 2>&1").c_str()) == 0; }

#if defined(__SANITIZE_ADDRESS__)
constexpr bool is_sanitized = true;
#else
constexpr bool is_sanitized = false;
#endif
constexpr const char* sanitizer_needs =
    "AddressSanitizer needs /proc, and more addresses than emulators and valgrind have";

class Pin : public Command {
 protected:
  /// The statement about its process in the folder's recording.
  std::string fact() const {
    const nlohmann::json info = done({"info", "pendulum.mcap", "--json"}).json();
    for (const nlohmann::json& record : info["metadata"])
      if (record["name"] == "rehearse") return record["values"].value("pinned", "not said");
    return "no provenance";
  }
  /// Records with that text before the command line; returns the recording's statement.
  std::string recorded(const std::string& before, const fs::path& program = command,
                       std::vector<std::string> words = {}) const {
    words.insert(words.end(), {"record", pendulum(MISBEHAVING, "none").string()});
    const Outcome outcome = run(program, words, before);
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    return exists("pendulum.mcap") ? fact() : "nothing";
  }
};

TEST_F(Pin, IsOnUnlessSaidOtherwise) {
  EXPECT_EQ(recorded(unpinned), "yes");
  EXPECT_EQ(recorded(unpinned + "REHEARSE_PIN=on "), "yes");
  EXPECT_EQ(recorded(unpinned + "REHEARSE_PIN= "), "yes");
}

TEST_F(Pin, IsTurnedOffByAnOptionOfAllVerbs) {
  EXPECT_EQ(recorded(unpinned, command, {"--no-pin"}), "no (REHEARSE_PIN=off)");
  const Outcome behind = run(command, {"record", "pendulum.yaml", "--no-pin"}, unpinned);
  EXPECT_EQ(behind.status, 0) << behind.err;
  EXPECT_EQ(fact(), "no (REHEARSE_PIN=off)");
  EXPECT_EQ(run(command, {"replay", "--no-pin", "pendulum.mcap"}, unpinned).status, 0);
  EXPECT_THAT(done({"--help"}).out, HasSubstr("--no-pin"));
}

TEST_F(Pin, IsTurnedOffByTheEnvironment) {
  EXPECT_EQ(recorded(unpinned + "REHEARSE_PIN=off "), "no (REHEARSE_PIN=off)");
}

TEST_F(Pin, ThatIsMisspeltIsRefused) {
  for (const std::vector<std::string>& words : {std::vector<std::string>{"record", "x.yaml"}, {"replay", "x.mcap"}}) {
    const Outcome outcome = run(command, words, unpinned + "REHEARSE_PIN=no ");
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.err, "error: REHEARSE_PIN is 'no': it may be 'on' (as if it weren't set) or 'off'\n");
  }
}

TEST_F(Pin, NeedsNoEnvironment) { EXPECT_EQ(recorded("env -i "), "yes"); }

TEST_F(Pin, KeepsTheUsersOwnTunablesAndSaysNothingOfThem) {
  EXPECT_EQ(recorded(unpinned), "yes");
  const std::string plain = read_file(folder() / "pendulum.mcap");
  EXPECT_EQ(recorded(unpinned + "GLIBC_TUNABLES=glibc.malloc.tcache_count=0 "), "yes");
  EXPECT_TRUE(read_file(folder() / "pendulum.mcap") == plain);
}

TEST_F(Pin, NeedsNoProc) {
  if (is_sanitized) GTEST_SKIP() << sanitizer_needs;
  const std::string without = "unshare -m sh -c 'mount -t tmpfs none /proc && exec \"$@\"' sh ";
  if (!can_run(without + "true")) GTEST_SKIP() << "mounting in a namespace of one's own is not permitted here";
  EXPECT_EQ(recorded(unpinned + without), "yes");
  EXPECT_EQ(recorded(unpinned + without, simulator), "yes") << "it starts itself again by the name it was started by";
}

TEST_F(Pin, ThatCanNotBeDoneIsSaid) {
  EXPECT_EQ(recorded(unpinned + "REHEARSE_PINNED=1 ", simulator), "no (it could not start itself again)");
}

/// In an emulator of another processor it would begin again outside of it.
TEST_F(Pin, FromOutsideStartsNothingAgain) {
  if (is_sanitized) GTEST_SKIP() << sanitizer_needs;
  if (!can_run("qemu-x86_64 --version")) GTEST_SKIP() << "qemu-user is not installed";
  const std::vector<std::string> words{"inspect", (fixtures / "models/pendulum.urdf").string()};
  const Outcome inside = run(reader, words, pinned_from_outside + "qemu-x86_64 -strace ");
  EXPECT_EQ(inside.status, 0) << inside.err;
  EXPECT_THAT(inside.err, HasSubstr("exit_group("));
  EXPECT_THAT(inside.err, Not(HasSubstr("execve(")));
  const Outcome leaves = run(reader, words, unpinned + "qemu-x86_64 -strace ");
  EXPECT_THAT(leaves.err, HasSubstr("execve(")) << "or this test would see nothing";
}

TEST_F(Pin, IsNotOfVerbsThatOnlyReadFiles) {
  if (is_sanitized) GTEST_SKIP() << sanitizer_needs;
  if (!can_run("qemu-x86_64 --version")) GTEST_SKIP() << "qemu-user is not installed";
  EXPECT_EQ(recorded(unpinned), "yes");
  const Outcome info = run(reader, {"info", "pendulum.mcap"}, unpinned + "qemu-x86_64 -strace ");
  EXPECT_EQ(info.status, 0) << info.err;
  EXPECT_THAT(info.err, Not(HasSubstr("execve("))) << "it would take twice as long";
}

/// A breakpoint in a controller survives that the process starts itself again, twice.
TEST_F(Pin, WorksUnderGdb) {
  const std::string gdb =
      "gdb -nx -batch -ex 'set breakpoint pending on' -ex 'break createSimpleController' -ex run -ex bt "
      "-ex 'info breakpoints' -ex delete -ex continue --args ";
  if (!can_run("gdb -nx -batch -ex run --args true")) GTEST_SKIP() << "gdb is not installed, or may trace nothing here";
  const Outcome outcome = run(command, {"record", pendulum(MISBEHAVING, "none").string()}, unpinned + gdb);
  EXPECT_THAT(outcome.out, ::testing::AllOf(HasSubstr("Breakpoint 1, "), HasSubstr("controller_setup.cpp:"),
                                            HasSubstr("breakpoint already hit 1 time")));
  EXPECT_EQ(fact(), "yes");
}

TEST_F(Pin, StaysUnderValgrind) {
  if (is_sanitized) GTEST_SKIP() << sanitizer_needs;
  if (!can_run("valgrind --version")) GTEST_SKIP() << "valgrind is not installed";
  const std::string valgrind = "valgrind --tool=none -q ";
  EXPECT_EQ(recorded(unpinned + valgrind, simulator), "no (it runs under valgrind, which it would leave)");
  EXPECT_EQ(recorded(unpinned + valgrind + "--trace-children=yes "), "yes");
  EXPECT_EQ(recorded(pinned_from_outside + valgrind, simulator), "yes");
}

TEST_F(Pin, ThatDiffersIsSaidByCheckAndReplay) {
  const std::string scenario = (fixtures / "scenarios/quadruped.yaml").string();
  ASSERT_EQ(run(command, {"record", scenario, "-o", "golden.mcap"}, unpinned).status, 0);
  const Outcome checked = run(command, {"--no-pin", "check", scenario, "--golden", "golden.mcap", "--json"}, unpinned);
  EXPECT_EQ(checked.status, 0) << checked.out << checked.err;
  EXPECT_THAT(
      checked.json()["comparisons"]["closed"]["remarks"],
      ::testing::ElementsAre("pinned was \"yes\" and is \"no (REHEARSE_PIN=off)\": everything may differ for that "
                             "alone"));
  const Outcome replayed = run(command, {"--no-pin", "replay", "golden.mcap"}, unpinned);
  if (replayed.status == 0) GTEST_SKIP() << "this processor rounds as a pinned process does";
  EXPECT_EQ(replayed.status, 1);
  EXPECT_THAT(replayed.err,
              HasSubstr("warning: this process may round differently than the process that recorded: pinned was "
                        "\"yes\" and is \"no (REHEARSE_PIN=off)\" (last bits may differ for this reason alone; "));
}

}  // namespace
}  // namespace rehearse::test
