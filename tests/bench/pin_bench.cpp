// The cost of pinning: the same work in a pinned process relative to one that isn't pinned.
#include <fcntl.h>
#include <rehearse/pin.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <string_view>

#include "pairs.h"
#include "pinned_child.h"
#include "sr1_run.h"

namespace rehearse {
namespace {

/// This program a second time, as a process that works on request.
class Child {
 public:
  Child(const char* work, bool pinned) {
    int orders[2], answers[2];
    if (pipe2(orders, O_CLOEXEC) != 0 || pipe2(answers, O_CLOEXEC) != 0) fail("no pipe");
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, orders[0], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&files, answers[1], STDOUT_FILENO);
    const std::string program = own_program().string();
    const std::vector<std::string> words{program, "--work", work};
    if (posix_spawn(&child_, program.c_str(), &files, nullptr, pointers_to(words).data(),
                    pointers_to(environment(pinned)).data()) != 0)
      fail("the child can't be started");
    posix_spawn_file_actions_destroy(&files);
    close(orders[0]);
    close(answers[1]);
    orders_ = orders[1];
    answers_ = answers[0];
    work_once();  // the child is ready after this
  }
  ~Child() {
    close(orders_);
    close(answers_);
    waitpid(child_, nullptr, 0);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  void work_once() {
    char byte = '!';
    if (write(orders_, &byte, 1) != 1 || read(answers_, &byte, 1) != 1) fail("the child has ended");
  }
  /// The clock of the child's total processor time.
  clockid_t clock() const {
    clockid_t clock{};
    if (clock_getcpuclockid(child_, &clock) != 0) fail("the child has no clock");
    return clock;
  }

 private:
  [[noreturn]] static void fail(const char* what) {
    std::fprintf(stderr, "error: %s: %s\n", what, std::strerror(errno));
    std::exit(1);
  }
  static std::vector<std::string> environment(bool pinned) {
    std::vector<std::string> variables;
    for (char** entry = environ; *entry; ++entry) {
      bool pins = std::string_view(*entry).starts_with("REHEARSE_PIN");
      for (const auto& [name, value] : pinned_environment()) pins |= std::string_view(*entry).starts_with(name + "=");
      if (!pins) variables.emplace_back(*entry);
    }
    if (!pinned) variables.emplace_back("REHEARSE_PIN=off");
    return variables;
  }
  static std::vector<char*> pointers_to(const std::vector<std::string>& words) {
    std::vector<char*> pointers;
    for (const std::string& word : words) pointers.push_back(strdup(word.c_str()));  // until this program ends
    pointers.push_back(nullptr);
    return pointers;
  }

  pid_t child_ = 0;
  int orders_ = -1, answers_ = -1;
};

void measure(benchmark::State& state, const char* work, double units) {
  Child pinned(work, true), unpinned(work, false);
  Pairs pairs(pinned.clock(), unpinned.clock());
  for (auto _ : Repeated(state))
    state.SetIterationTime(pairs.measure([&] { pinned.work_once(); }, [&] { unpinned.work_once(); }));
  pairs.report(state, units, units);
}

/// Work: 100 ticks of SR1's closed loop, recorded, in a pinned process. Base: the same in one that isn't.
void pinned_closed_loop_over_unpinned(benchmark::State& state) { measure(state, "closed loop", 100); }
BENCHMARK(pinned_closed_loop_over_unpinned)->UseManualTime()->Unit(benchmark::kMillisecond);

/// Work: SR1's two cameras, drawn, encoded and recorded, in a pinned process. Base: the same in one that isn't.
void pinned_frame_over_unpinned(benchmark::State& state) { measure(state, "frame", 2); }
BENCHMARK(pinned_frame_over_unpinned)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace

int run_child(const std::string& name) {
  const Work work = name == "frame" ? make_recorded_frame_work() : make_closed_loop_work();
  for (char byte = 0; read(STDIN_FILENO, &byte, 1) == 1;) {
    work();
    if (write(STDOUT_FILENO, &byte, 1) != 1) return 1;
  }
  return 0;
}

}  // namespace rehearse
