#include "process_guard.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits.h>
#include <rehearse/pin.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <clocale>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <locale>
#include <set>
#include <sstream>

#include "c_library.h"
#include "guarded_call.h"
#include "own_library.h"

namespace rehearse {

thread_local constinit const ThreadCount* own_threads = nullptr;

namespace {

using Kind = Trespass::Kind;

std::string name_of_signal(int signal_number) {
  const char* name = sigabbrev_np(signal_number);
  return name ? fmt::format("SIG{}", name) : fmt::format("signal {}", signal_number);
}

/// "SIGINT and SIGTERM"; for many signals their number.
std::string names_of(const std::vector<int>& signals) {
  if (signals.size() > 4) return fmt::format("{} signals", signals.size());
  std::string text;
  for (std::size_t i = 0; i < signals.size(); ++i)
    text += (i == 0 ? "" : i + 1 == signals.size() ? " and " : ", ") + name_of_signal(signals[i]);
  return text;
}

std::string working_directory() {
  std::array<char, PATH_MAX> path;
  return getcwd(path.data(), path.size()) ? path.data() : "";
}

/// The environment in its order, each variable with a zero at its end.
std::string environment_block() {
  std::string all;
  for (char** entry = environ; entry && *entry; ++entry) all.append(*entry, std::strlen(*entry) + 1);
  return all;
}

/// The variables of such a block, sorted.
std::vector<std::string> variables_in(const std::string& block) {
  std::vector<std::string> all;
  for (std::size_t begin = 0; begin < block.size(); begin += all.back().size() + 1)
    all.emplace_back(block.c_str() + begin);
  std::ranges::sort(all);
  return all;
}

std::vector<std::string> variables() { return variables_in(environment_block()); }

/// The name in "NAME=value".
std::string name_of_variable(const std::string& variable) { return variable.substr(0, variable.find('=')); }

std::string c_locale() {
  const char* name = std::setlocale(LC_ALL, nullptr);
  return name ? name : "";
}

/// The categories of a locale's name ("LC_CTYPE=C;LC_NUMERIC=de_DE;...") that have changed.
std::string changed_categories(const std::string& before, const std::string& now) {
  if (now.find(';') == std::string::npos) return now;
  std::string changed;
  std::istringstream categories(now);
  for (std::string one; std::getline(categories, one, ';');) {
    const bool as_before = before.find(';') == std::string::npos ? one.substr(one.find('=') + 1) == before
                                                                 : (before + ";").find(one + ";") != std::string::npos;
    if (!as_before) changed += (changed.empty() ? "" : ", ") + one;
  }
  return changed;
}

mode_t current_umask() {
  const mode_t mask = umask(077);
  umask(mask);
  return mask;
}

bool is_armed(const itimerval& timer) { return timer.it_value.tv_sec != 0 || timer.it_value.tv_usec != 0; }

/// Prints a line if controllers run without the replacements of the C library's functions.
void tell_missing_guards() {
  if (replaces_functions()) return;
  std::fprintf(stderr,
               "warning: this program loads the C library before librehearse_harness, so guards are off: a controller "
               "that calls exit, _exit or exec, or whose thread fails, ends the program; it can close any file and "
               "fork; what control() changes in the process, and files that it reads, aren't noticed%s (link "
               "librehearse_harness before the C library, or start the program with LD_PRELOAD=%s)\n",
               is_pinned() ? "" : "; mathematics isn't pinned",
               (own_library_folder() / "librehearse_harness.so").c_str());
}

constexpr __rlimit_resource limited[] = {RLIMIT_AS,     RLIMIT_CPU,   RLIMIT_DATA, RLIMIT_FSIZE,
                                         RLIMIT_NOFILE, RLIMIT_NPROC, RLIMIT_STACK};
using Limits = std::array<rlimit, std::size(limited)>;

Limits limits() {
  Limits all{};
  for (std::size_t i = 0; i < all.size(); ++i) getrlimit(limited[i], &all[i]);
  return all;
}

constexpr int timers[] = {ITIMER_REAL, ITIMER_VIRTUAL, ITIMER_PROF};
constexpr int signal_count = NSIG;

/// The action of a signal as the kernel has it. The C library's form has five times the size, and 62 are read after
/// each call that is watched closely.
struct SignalAction {
  void (*handler)(int) = SIG_DFL;
  unsigned long flags = 0;
  void (*restorer)() = nullptr;
  std::uint64_t mask = 0;
};
using SignalActions = std::array<SignalAction, signal_count>;

void exchange_action(int signal_number, const SignalAction* action, SignalAction* before) {
  ::syscall(SYS_rt_sigaction, signal_number, action, before, sizeof(SignalAction::mask));
}

/// Without those of the C library's own signals, which are below SIGRTMIN.
SignalActions signal_actions() {
  SignalActions actions{};
  for (int i = 1; i < signal_count; ++i)
    if (i <= SIGSYS || i >= SIGRTMIN) exchange_action(i, nullptr, &actions[i]);
  return actions;
}

/// The actions after the last call that was watched closely. They are those before the next one unless the program has
/// changed one meanwhile, which the replacements of the C library's functions note.
SignalActions last_actions;
std::atomic<bool> knows_last_actions{false};

}  // namespace

namespace {
const Limits* limits_at_start = nullptr;
}

/// The state of the whole process at one time.
struct ProcessGuard::State {
  std::string directory = working_directory();
  SignalActions actions;
  sigset_t blocked{};
  std::array<itimerval, std::size(timers)> armed{};
  std::string locale = c_locale();
  locale_t thread_locale = uselocale(nullptr);
  std::locale cpp_locale;
  std::string environment = environment_block();
  mode_t file_mask = current_umask();

  explicit State(const SignalActions& present) : actions(present) {
    pthread_sigmask(SIG_BLOCK, nullptr, &blocked);
    for (std::size_t i = 0; i < std::size(timers); ++i) getitimer(static_cast<__itimer_which>(timers[i]), &armed[i]);
  }

  void restore_directory(const State& now, std::vector<Trespass>& found) const {
    if (now.directory == directory) return;
    const bool back = chdir(directory.c_str()) == 0;
    found.push_back({Kind::directory, fmt::format("changed the working directory to '{}'; it {}", now.directory,
                                                  back ? "was set back" : "can't be set back")});
  }

  void restore_actions(const State& now, std::vector<Trespass>& found) const {
    std::vector<int> handled, ignored, left;
    for (int i = 1; i < signal_count; ++i) {
      const auto handler = now.actions[i].handler;
      if (handler == actions[i].handler) continue;
      (handler == SIG_IGN ? ignored : handler == SIG_DFL ? left : handled).push_back(i);
      exchange_action(i, &actions[i], nullptr);
      note_change_of_actions();
    }
    std::vector<std::string> deeds;
    if (!handled.empty()) deeds.push_back(fmt::format("installed a handler of its own for {}", names_of(handled)));
    if (!ignored.empty()) deeds.push_back(fmt::format("ignored {}", names_of(ignored)));
    if (!left.empty()) deeds.push_back(fmt::format("took away the handler of {}", names_of(left)));
    if (!deeds.empty()) found.push_back({Kind::signals, fmt::format("{}; it was set back", fmt::join(deeds, " and "))});
  }

  void restore_mask(const State& now, std::vector<Trespass>& found) const {
    std::vector<int> blocks, unblocks;
    for (int i = 1; i < signal_count; ++i) {
      const int before = sigismember(&blocked, i), after = sigismember(&now.blocked, i);
      if (before != after) (after ? blocks : unblocks).push_back(i);
    }
    if (blocks.empty() && unblocks.empty()) return;
    pthread_sigmask(SIG_SETMASK, &blocked, nullptr);
    const bool both = !blocks.empty() && !unblocks.empty();
    found.push_back(
        {Kind::mask, fmt::format("{}{}{}{}{}; it was set back", blocks.empty() ? "" : "blocked ", names_of(blocks),
                                 both ? " and " : "", unblocks.empty() ? "" : "unblocked ", names_of(unblocks))});
  }

  void restore_timers(const State& now, std::vector<Trespass>& found) const {
    bool changed = false;
    for (std::size_t i = 0; i < std::size(timers); ++i) {
      // A timer of the host that still runs is no change by the code.
      if (is_armed(armed[i]) || !is_armed(now.armed[i])) continue;
      changed = true;
      const itimerval off{};
      setitimer(static_cast<__itimer_which>(timers[i]), &off, nullptr);
    }
    if (changed) found.push_back({Kind::timers, "set a timer of the process (alarm or setitimer); it was stopped"});
  }

  void restore_locale(const State& now, std::vector<Trespass>& found) const {
    const bool c_changed = now.locale != locale, cpp_changed = now.cpp_locale != cpp_locale;
    const bool thread_changed = now.thread_locale != thread_locale;
    if (!c_changed && !cpp_changed && !thread_changed) return;
    const std::string to = c_changed        ? changed_categories(locale, now.locale)
                           : thread_changed ? std::string("another one of this thread")
                                            : now.cpp_locale.name();
    if (thread_changed) uselocale(thread_locale);
    if (cpp_changed) std::locale::global(cpp_locale);
    std::setlocale(LC_ALL, locale.c_str());
    found.push_back({Kind::locale, fmt::format("set the locale to '{}'; it was set back", to)});
  }

  void compare_environment(const State& now, std::vector<Trespass>& found) const {
    if (now.environment == environment) return;
    const std::vector<std::string> before = variables_in(environment), after = variables_in(now.environment);
    std::vector<std::string> changed;
    std::set_symmetric_difference(before.begin(), before.end(), after.begin(), after.end(),
                                  std::back_inserter(changed));
    if (changed.empty()) return;
    std::set<std::string> names;
    for (const std::string& variable : changed) names.insert(name_of_variable(variable));
    found.push_back({Kind::environment,
                     fmt::format("changed the environment of the whole process: {}; it is set back after the run",
                                 names.size() > 5 ? fmt::format("{} variables", names.size())
                                                  : fmt::format("{}", fmt::join(names, ", ")))});
  }

  void restore_umask(const State& now, std::vector<Trespass>& found) const {
    if (now.file_mask == file_mask) return;
    umask(file_mask);
    found.push_back({Kind::umask, fmt::format("changed the umask to {:03o}; it was set back", now.file_mask)});
  }
};

namespace {

/// The environment before the first of the runs that are under way.
struct {
  std::mutex mutex;
  int runs = 0;
  std::vector<std::string> variables;
} before_runs;

}  // namespace

RunEnvironment::RunEnvironment() {
  const std::scoped_lock lock(before_runs.mutex);
  if (before_runs.runs++ == 0) before_runs.variables = variables();
}

RunEnvironment::~RunEnvironment() {
  const std::scoped_lock lock(before_runs.mutex);
  if (--before_runs.runs > 0) return;
  const std::vector<std::string> now = variables(), &before = before_runs.variables;
  const auto lacks = [](const std::vector<std::string>& all, const std::string& one) {
    return !std::ranges::binary_search(all, one);
  };
  for (const std::string& variable : now)
    if (lacks(before, variable)) unsetenv(name_of_variable(variable).c_str());
  for (const std::string& variable : before) {
    if (!lacks(now, variable)) continue;
    const std::string name = name_of_variable(variable);
    setenv(name.c_str(), variable.c_str() + std::min(name.size() + 1, variable.size()), 1);
  }
}

ProcessGuard::ProcessGuard()
    : protected_{{STDIN_FILENO, "stdin"}, {STDOUT_FILENO, "stdout"}, {STDERR_FILENO, "stderr"}} {}
ProcessGuard::~ProcessGuard() = default;

ProcessGuard& ProcessGuard::instance() {
  static auto& guard = *new ProcessGuard;  // threads of controllers may outlive all static objects
  return guard;
}

void ProcessGuard::protect(int descriptor, std::string name) {
  if (descriptor < 0) return;
  const std::scoped_lock lock(mutex_);
  protected_.emplace_back(descriptor, std::move(name));
}

void ProcessGuard::release(int descriptor) {
  const std::scoped_lock lock(mutex_);
  protected_.erase(
      std::remove_if(protected_.begin(), protected_.end(), [&](const auto& one) { return one.first == descriptor; }),
      protected_.end());
}

void ProcessGuard::begin(ThreadCount threads, bool closely) {
  static const bool told = (tell_missing_guards(), true);
  static_cast<void>(told);
  threads_ = std::move(threads);
  static const Limits at_start = limits();
  limits_at_start = &at_start;
  prepare_guarded_calls();  // so that the host's own handlers don't count as changes by the code
  if (!closely) return;
  static const bool notes_changes = replaces_functions();
  before_ = std::make_unique<State>(notes_changes && knows_last_actions ? last_actions : signal_actions());
}

void ProcessGuard::note_change_of_actions() { knows_last_actions = false; }

/// A hard limit that was lowered can't be raised again.
void ProcessGuard::restore_limits() {
  if (!limits_at_start) return;
  const Limits now = limits();
  bool changed = false;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const rlimit& before = (*limits_at_start)[i];
    if (now[i].rlim_cur == before.rlim_cur && now[i].rlim_max == before.rlim_max) continue;
    changed = true;
    const rlimit highest{std::min(before.rlim_cur, now[i].rlim_max), now[i].rlim_max};
    if (setrlimit(limited[i], &before) != 0) setrlimit(limited[i], &highest);
  }
  if (changed) note({Kind::limits, "set another resource limit, past the C library; it was set back"});
}

void ProcessGuard::before_change() {
  if (before_ || looking_ || !in_guarded_call()) return;
  looking_ = true;  // reading the umask means to change it
  before_ = std::make_unique<State>(signal_actions());
  looking_ = false;
}

void ProcessGuard::note(Trespass trespass) {
  const std::scoped_lock lock(mutex_);
  noted_.push_back(std::move(trespass));
  has_noted_ = true;
}

bool ProcessGuard::keeps(int descriptor) {
  if (!in_guarded_call() && !own_threads) return false;
  std::string name;
  {
    const std::scoped_lock lock(mutex_);
    const auto found = std::ranges::find_if(protected_, [&](const auto& one) { return one.first == descriptor; });
    if (found == protected_.end()) return false;
    name = found->second;
  }
  note({Kind::descriptors, std::move(name)});
  return true;
}

std::vector<unsigned int> ProcessGuard::kept_in(unsigned int first, unsigned int last) {
  std::vector<unsigned int> kept;
  {
    const std::scoped_lock lock(mutex_);
    for (const auto& [descriptor, name] : protected_)
      if (const auto number = static_cast<unsigned int>(descriptor); number >= first && number <= last)
        kept.push_back(number);
  }
  for (const unsigned int descriptor : kept) keeps(static_cast<int>(descriptor));
  std::ranges::sort(kept);
  return kept;
}

bool ProcessGuard::keeps_signal(int signal_number) {
  if (!in_guarded_call() || !ends_calls(signal_number)) return false;
  note({Kind::signals, name_of_signal(signal_number)});
  return true;
}

ThreadCount ProcessGuard::threads_here() const {
  if (in_guarded_call()) return threads_;
  return own_threads ? *own_threads : nullptr;
}

void ProcessGuard::note_thread_exit(const char* deed) {
  note({Kind::thread_exit, fmt::format("started a thread that {}; that thread was stopped for good", deed)});
}

void ProcessGuard::note_limit() {
  note({Kind::limits, "asked for another resource limit of the process (setrlimit); it stays as it is"});
}

void ProcessGuard::note_fork() {
  note({Kind::fork, "forked; the run is the parent's, and the child ends where the call ends in it"});
}

std::vector<Trespass> ProcessGuard::put_right() {
  std::vector<Trespass> found;
  threads_ = nullptr;
  if (const std::unique_ptr<State> before = std::exchange(before_, nullptr)) {
    restore_limits();
    knows_last_actions = true;  // before they are read: a thread may change them meanwhile
    last_actions = signal_actions();
    const State now(last_actions);
    before->restore_directory(now, found);
    before->restore_actions(now, found);
    before->restore_mask(now, found);
    before->restore_timers(now, found);
    before->restore_locale(now, found);
    before->compare_environment(now, found);
    before->restore_umask(now, found);
  }
  if (!has_noted_) return found;
  const std::scoped_lock lock(mutex_);
  std::set<std::string> descriptors, signals;
  for (Trespass& one : std::exchange(noted_, {})) {
    if (one.kind == Kind::descriptors)
      descriptors.insert(std::move(one.deed));
    else if (one.kind == Kind::signals)
      signals.insert(std::move(one.deed));
    else
      found.push_back(std::move(one));
  }
  has_noted_ = false;
  if (!descriptors.empty())
    found.push_back({Kind::descriptors, fmt::format("closed file descriptors that are not its own ({}); they were kept "
                                                    "open",
                                                    fmt::join(descriptors, ", "))});
  if (!signals.empty())
    found.push_back({Kind::signals, fmt::format("took over {}, by which a crash or a hang is survived; it was not let",
                                                fmt::join(signals, ", "))});
  return found;
}

}  // namespace rehearse
