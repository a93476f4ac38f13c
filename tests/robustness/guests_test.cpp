// Hostile and clumsy controllers: however one ends its process, the run ends soon, its message names controller,
// function and tick, and its recording is whole and has all ticks before the failure. The page
// contribute/robustness_tests.md has the table.
#include "command.h"
#include "support/printed_by_name.h"

#include <gmock/gmock.h>

#include <pty.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <string_view>

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define REHEARSE_ADDRESS_SANITIZER
#endif
#endif
/// The words about damage that a sanitizer reports in its own words, before it ends the process.
#if defined(REHEARSE_ADDRESS_SANITIZER) || defined(__SANITIZE_ADDRESS__)
constexpr double call_limit = 3.0;  // [s]
constexpr const char* hung = "did not return within 3 s";
constexpr const char* allocating = " in control()";  // freed memory is kept for a while: another limit may come first
constexpr const char* damaged = "ended the process with exit status 1";
constexpr const char* no_memory = damaged;
constexpr const char* thread_damaged = damaged;
#else
constexpr double call_limit = 1.0;  // [s]
constexpr const char* hung = "did not return within 1 s";
constexpr const char* allocating = hung;
constexpr const char* damaged = "crashed: ";
constexpr const char* no_memory = "std::bad_alloc";
constexpr const char* thread_damaged = "started a thread that crashed";
#endif

/// How a run may end.
enum class End {
  failed,   // status 3, with the tick
  at_stop,  // status 3, when the controller is destroyed after the last tick
  either,   // the damage may stay without effect
  harmless,
  unknown,        // status 3, and nothing is certain about the place
  trace_changed,  // status 3, and the recording is lost or damaged
};

struct Deed {
  const char* name;
  End end;
  const char* words = "";  // of the message
};
class Guests : public Command, public ::testing::WithParamInterface<Deed> {
 protected:
  /// Longer for those that take much memory, of which some machines give 250 MB a second, and for a thousand threads
  /// that take turns, each of which waits for a processor on a busy machine.
  static double limit() {
    const std::string_view name = GetParam().name;
    return name == "all_memory" || name == "million_allocations" || name == "threads" ? 10.0 : call_limit;
  }
  Outcome record() {
    const auto begin = std::chrono::steady_clock::now();
    const fs::path scenario = pendulum(GUEST, std::string(GetParam().name) + " " + (folder() / "t.mcap").string());
    Outcome outcome = rehearse(
        {"record", scenario.string(), "-o", "t.mcap", "--call-limit", std::to_string(limit()), "--memory-limit", "500"},
        "ASAN_OPTIONS=detect_leaks=0");
    seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return outcome;
  }
  nlohmann::json info() const {
    const Outcome checked = rehearse({"doctor", "t.mcap"});
    EXPECT_EQ(checked.status, 0) << checked.out << checked.err;
    return rehearse({"info", "t.mcap", "--json"}).json();
  }
  static nlohmann::json outcome_in(const nlohmann::json& info) {
    for (const nlohmann::json& record : info["metadata"])
      if (record["name"] == "rehearse.outcome") return record["values"];
    return {};
  }
  void expect_failure(const Outcome& outcome) const {
    const bool at_stop = GetParam().end == End::at_stop;
    EXPECT_EQ(outcome.status, 3) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("'Pendulum/Swing'"));
    EXPECT_THAT(outcome.err, HasSubstr(GetParam().words));
    EXPECT_THAT(outcome.err, HasSubstr(at_stop ? "in ~SimpleController()" : "in control() at tick 1"));
    const nlohmann::json facts = info();
    EXPECT_GE(facts["ticks"], 12);
    EXPECT_EQ(outcome_in(facts)["complete"], "false");
    EXPECT_THAT(outcome.err, HasSubstr(outcome_in(facts)["failure"].get<std::string>()));
  }
  void expect_harmless(const Outcome& outcome) const {
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("50 ticks")) << outcome.err;
    EXPECT_EQ(outcome_in(info())["complete"], "true");
  }

  double seconds_ = 0.0;  // of the last record()
};

INSTANTIATE_TEST_SUITE_P(
    Of, Guests,
    ::testing::Values(
        Deed{"nothing", End::harmless}, Deed{"overrun_8", End::either}, Deed{"overrun_2000", End::failed, damaged},
        Deed{"overrun_large", End::failed, damaged},
        Deed{"crash_without_heap", End::failed, "crashed: segmentation fault"},
        Deed{"double_free", End::failed, damaged}, Deed{"free_of_stack", End::failed, damaged},
        Deed{"use_after_free", End::either}, Deed{"wild_write", End::failed, "crashed: segmentation fault"},
        Deed{"null", End::failed, "crashed: segmentation fault"},
        Deed{"null_to_strlen", End::failed, "crashed: segmentation fault"}, Deed{"million_allocations", End::harmless},
        Deed{"all_memory", End::failed, "took more than 500 MB of memory"}, Deed{"unmap_stack_end", End::failed},
        Deed{"shared_memory", End::unknown, "a controller wrote over memory"},
        Deed{"recursion", End::failed, "its stack overflowed"}, Deed{"longjmp", End::either},
        Deed{"throw", End::failed, "no gait"}, Deed{"throw_number", End::failed, "threw something"},
        Deed{"terminate_in_destructor", End::failed, "threw std::runtime_error: no destructor may throw"},
        Deed{"assert", End::failed, "crashed: it called abort"}, Deed{"abort", End::failed, "crashed: it called abort"},
        Deed{"illegal_instruction", End::failed, "crashed: illegal instruction"},
        Deed{"division", End::failed, "crashed: arithmetic fault"}, Deed{"exit", End::failed, "called exit(0)"},
        Deed{"quick_exit", End::failed, "called quick_exit(0)"}, Deed{"raw_exit", End::failed, "with exit status 0"},
        Deed{"raw_exit_in_thread", End::failed, "with exit status 0"},
        Deed{"raw_exec", End::failed, "with exit status 0"}, Deed{"kill", End::failed, "by SIGKILL"},
        Deed{"term_group", End::failed, "by SIGTERM"}, Deed{"kill_group", End::failed, "by SIGKILL"},
        Deed{"stop", End::failed, hung}, Deed{"stop_group", End::failed, hung}, Deed{"traced", End::either},
        Deed{"traced_and_stopped", End::failed, hung}, Deed{"strict_seccomp", End::failed},
        Deed{"no_memory_limit", End::failed, no_memory}, Deed{"no_descriptors", End::harmless},
        Deed{"no_file_size", End::harmless}, Deed{"fork_many", End::harmless}, Deed{"fork_and_return", End::harmless},
        Deed{"spin", End::failed, hung}, Deed{"sleep", End::failed, hung}, Deed{"deadlock", End::failed, hung},
        Deed{"full_pipe", End::failed, hung}, Deed{"print_forever", End::failed, hung},
        Deed{"block_and_spin", End::failed, hung}, Deed{"allocate_forever", End::failed, allocating},
        Deed{"own_handlers", End::failed, hung}, Deed{"timer", End::failed, "was ended by SIGALRM"},
        Deed{"spin_at_unload", End::harmless}, Deed{"spin_in_destructor", End::at_stop, hung},
        Deed{"threads", End::harmless}, Deed{"thread_crash", End::failed, "started a thread that crashed"},
        Deed{"thread_abort", End::failed, "started a thread that crashed: it called abort"},
        Deed{"thread_overrun", End::failed, thread_damaged},
        Deed{"thread_throw", End::failed, "started a thread that threw"}, Deed{"close_all", End::harmless},
        Deed{"dup_over_everything", End::harmless}, Deed{"unlink_trace", End::trace_changed, "has deleted the trace"},
        Deed{"cut_trace", End::trace_changed, "the trace while it was written"},
        Deed{"replace_trace", End::trace_changed, "deleted the trace"},
        Deed{"write_into_trace", End::trace_changed, "has written into the trace"}),
    test::by_name);

TEST_P(Guests, EndTheRunSoonWithItsRecordingWhole) {
  const Outcome outcome = record();
  EXPECT_LT(seconds_, limit() + 1.0 + 2.0) << "two seconds are for a busy machine";
  switch (GetParam().end) {
    case End::harmless: return expect_harmless(outcome);
    case End::either:
      if (outcome.status == 0) return expect_harmless(outcome);
      EXPECT_EQ(outcome.status, 3) << outcome.err;
      EXPECT_THAT(outcome.err, HasSubstr("'Pendulum/Swing'"));
      EXPECT_GE(info()["ticks"], 13);
      return;
    case End::failed:
    case End::at_stop: return expect_failure(outcome);
    case End::unknown:
      EXPECT_EQ(outcome.status, 3);
      EXPECT_THAT(outcome.err, HasSubstr(GetParam().words));
      EXPECT_EQ(outcome_in(info())["complete"], "false");
      return;
    case End::trace_changed:
      EXPECT_EQ(outcome.status, 3);
      EXPECT_THAT(outcome.err, HasSubstr(GetParam().words));
      EXPECT_EQ(outcome.out, "");
  }
}

/// Its process isn't in the foreground of the terminal until it reads from there.
TEST_F(Command, AGuestReadsFromTheTerminal) {
  const fs::path scenario = pendulum(GUEST, "read_terminal");
  int terminal = -1;
  const pid_t program = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (program == 0) {
    if (chdir(folder().c_str()) == 0)
      execl(command.c_str(), command.c_str(), "record", scenario.c_str(), "-o", "t.mcap", nullptr);
    _exit(127);
  }
  ASSERT_EQ(::write(terminal, "go\n", 3), 3);
  int status = 0;
  ASSERT_EQ(waitpid(program, &status, 0), program);
  close(terminal);
  EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : -1, 0);
}

/// The state of a process as in /proc/PID/stat: 'T' for a stopped one.
char state_of(pid_t process) {
  const std::string status = read_file("/proc/" + std::to_string(process) + "/stat");
  const std::size_t end = status.rfind(") ");
  return end == std::string::npos ? '?' : status[end + 2];
}

/// A stopped process can't continue itself: the page contribute/robustness_tests.md states it.
TEST_F(Command, AGuestStopsItsParentUntilSomebodyContinuesIt) {
  for (const char* deed : {"stop_parent", "attach_to_parent"}) {
    const fs::path scenario = pendulum(GUEST, deed);
    const pid_t program = fork();
    if (program == 0) {
      if (chdir(folder().c_str()) == 0)
        execl(command.c_str(), command.c_str(), "record", scenario.c_str(), "-o", "t.mcap", nullptr);
      _exit(127);
    }
    int status = 0;
    pid_t ended = 0;
    for (int i = 0; i < 600 && ended == 0; ++i, usleep(50000)) {
      if (i > 20 && (state_of(program) == 'T' || state_of(program) == 't')) kill(program, SIGCONT);
      ended = waitpid(program, &status, WNOHANG);
    }
    if (ended == 0) kill(program, SIGKILL);
    ASSERT_EQ(ended, program) << deed;
    EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : -1, 0) << deed;
    EXPECT_EQ(rehearse({"doctor", "t.mcap"}).status, 0) << deed;
  }
}

class AuditedGuests : public Command, public ::testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Of, AuditedGuests,
                         ::testing::Values("overrun_2000", "overrun_large", "double_free", "free_of_stack", "deadlock",
                                           "allocate_forever"),
                         [](const auto& deed) { return std::string(deed.param); });

TEST_P(AuditedGuests, AreNamedWithTheirTick) {
  const auto begin = std::chrono::steady_clock::now();
  const Outcome outcome = rehearse({"audit", pendulum(GUEST, GetParam()).string(), "--call-limit", "1"});
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("failed: controller 'Pendulum/Swing' "));
  EXPECT_THAT(outcome.out, HasSubstr(" in control() at tick 12"));
}

}  // namespace
}  // namespace rehearse::test
