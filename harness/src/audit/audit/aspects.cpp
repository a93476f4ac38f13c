#include "aspects.h"

#include <algorithm>
#include <string>

namespace rehearse {
namespace {

using Source = ObservedCall::Source;

/// Functions that change something, and whose result states only success.
constexpr std::string_view deeds =
    " alarm bind chdir chmod clearenv close close_range closefrom dlopen exit fchdir fchmodat initstate kill lcong48 "
    "mkdir mkdtemp mkostemp mkstemp pthread_setaffinity_np pthread_sigmask putenv quick_exit raise remove rename rmdir "
    "sched_setaffinity seed48 setenv setitimer shm_unlink sigaction signal sigprocmask socket srand srand48 srandom "
    "tmpfile truncate tzset umask unlink unlinkat unsetenv uselocale utimensat _exit _Exit abort ";

/// Functions that open a file; such a call has an effect only if the file isn't opened for reading.
constexpr std::string_view openings = " creat fopen freopen open openat shm_open ";

/// Functions that run a program, or a second process.
constexpr std::string_view programs = " execv execve execvp fork popen posix_spawn posix_spawnp system vfork ";

struct AspectGroup {
  std::string_view functions;  // each between spaces
  std::string_view words;
  std::optional<Factor> factor;
};
constexpr AspectGroup surroundings[] = {
    {" get_nprocs get_nprocs_conf pthread_getaffinity_np pthread_setaffinity_np sched_getaffinity sched_setaffinity ",
     "the number of processors", Factor::machine},
    {" getcpu sched_getcpu ", "the processor that it runs on", Factor::machine},
    {" gethostid gethostname uname ", "the machine's name", Factor::machine},
    {" getloadavg ", "the machine's load", Factor::machine},
    {" sysinfo ", "the machine's load and memory", Factor::machine},
    {" ioctl isatty ttyname ttyname_r ", "the terminal", Factor::machine},
    {" getegid geteuid getgid getlogin getlogin_r getpwuid getpwuid_r getuid ", "the user", Factor::machine},
    {" getppid getpriority getrlimit ", "the process it runs in", Factor::machine},
    {" getpid gettid ", "the process it runs in", Factor::nothing},  // different in each process
    {" get_current_dir_name getcwd ", "the working folder", Factor::folder},
    {" getauxval ", "the kernel's data on the processor and the process", std::nullopt},
};

Aspect surroundings_of(const ObservedCall& call) {
  if (call.function == "sysconf")
    return {call.argument.starts_with("_SC_NPROCESSORS") ? "the number of processors" : "the machine's memory",
            Factor::machine};
  if (call.argument == "/proc/loadavg") return {"the machine's load", Factor::machine};
  if (call.argument.starts_with("/") && call.argument.ends_with("hostname"))
    return {"the machine's name", Factor::machine};
  for (const AspectGroup& group : surroundings)
    if (is_one_of(call.function, group.functions)) return {group.words, group.factor};
  return {"the environment", Factor::environment};
}

/// Functions that list a folder. An imaginary machine lists in another order, where that can be changed.
constexpr std::string_view listings_in_order =
    " fdopendir fts64_open fts_open opendir scandir scandir64 scandirat scandirat64 ";
constexpr std::string_view listings_as_they_are = " ftw ftw64 getdents glob glob64 nftw nftw64 wordexp ";
/// Functions of memory, semaphores and queues that processes share by a number.
constexpr std::string_view shared_by_number = " msgget semget shmat shmget ";

bool is_listing(const ObservedCall& call) {
  return is_one_of(call.function, listings_in_order) || is_one_of(call.function, listings_as_they_are);
}

Aspect file_aspect_of(const ObservedCall& call) {
  if (is_one_of(call.function, shared_by_number)) return {"what processes share by a number", std::nullopt};
  // wordexp() gets words, not a name; "..." stands for further names at the same place
  const bool is_relative =
      !call.argument.empty() && call.argument.front() != '/' && call.argument != "..." && call.function != "wordexp";
  const bool is_own = !call.digest.empty();  // of a folder that the controller made: it determined the names
  if (is_listing(call) && is_relative && !is_own)
    return {"the entries of a folder named relative to the working folder", Factor::folder};
  if (is_one_of(call.function, listings_in_order))
    return {.words = "the order of a folder's entries", .factor = Factor::machine, .in_part = !is_own};
  if (is_listing(call)) return {"the entries of a folder", std::nullopt};
  Aspect aspect{"a file", std::nullopt};
  if (is_relative) aspect = {"the working folder", Factor::folder};
  aspect.has_answer = !is_one_of(call.function, openings) || !call.digest.empty();
  return aspect;
}

}  // namespace

bool is_one_of(std::string_view word, std::string_view words) {
  return words.find(" " + std::string(word) + " ") != std::string_view::npos;
}

Aspect aspect_of(const ObservedCall& call) {
  const auto aspect = [&]() -> Aspect {
    switch (call.source) {
      case Source::clock:
        return {call.function == "getrusage" ? "the time and memory that the process has used" : "the clock",
                Factor::clock};
      case Source::random: return {"random numbers", Factor::random};
      case Source::thread:
        if (is_one_of(call.function, programs)) return {"another program", std::nullopt};
        if (call.argument == in_turns) return {.words = "the order of its threads", .factor = {}, .has_answer = false};
        return {"the order of its threads", Factor::threads};
      case Source::file: return file_aspect_of(call);
      case Source::network: return {"the network", std::nullopt};
      case Source::environment: return surroundings_of(call);
      case Source::locale: return {"the locale", Factor::locale};
      case Source::process: return {"the kernel", std::nullopt};
      case Source::cost: break;  // only logged by an audit of costs
    }
    return {};
  };
  Aspect result = aspect();
  if (is_one_of(call.function, deeds)) result.has_answer = false;
  return result;
}

bool is_of_own_file(const std::vector<ObservedCall>& calls, const ObservedCall& call) {
  if (call.source != Source::file || is_listing(call)) return false;
  for (const ObservedCall& earlier : calls) {
    if (&earlier == &call) return false;
    if (earlier.source != Source::file || earlier.argument != call.argument || earlier.controller != call.controller)
      continue;
    if (is_one_of(earlier.function, openings)) return earlier.digest.empty();
  }
  return false;
}

}  // namespace rehearse
