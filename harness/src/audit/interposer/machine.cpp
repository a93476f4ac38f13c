// The machine, its user and the terminal: the real ones, or those of an imaginary machine with a number.
#include "machine.h"

#include <errno.h>
#include <pwd.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/sysinfo.h>
#include <sys/utsname.h>
#include <termios.h>
#include <unistd.h>

#include "next.h"
#include "watching.h"

namespace rehearse::interposer {
namespace {

/// Number 1 is for still replays; even numbers are small machines, odd ones large machines.
struct Machine {
  int number;
  int processors() const { return number == 1 ? 4 : number % 2 == 0 ? 1 : 8 * number; }
  double load() const { return number == 1 ? 0.25 : 0.5 + 1.75 * number; }
  long gibibytes() const { return number == 1 ? 8 : number % 2 == 0 ? 2 : 32 * number; }
  unsigned user() const { return 1000u + static_cast<unsigned>(number); }
  bool has_terminal() const { return number != 1; }
  winsize terminal() const {
    return {static_cast<unsigned short>(20 + 9 * number), static_cast<unsigned short>(70 + 31 * number), 0, 0};
  }
  /// "machine-2xx", "user-2xx": the lengths differ, too.
  void name(const char* kind, char* to, size_t size) const {
    snprintf(to, size, "%s%d%.*s", kind, number, number, "xxxxxxxx");
  }
};

const char* name_of_query(int name) {
  switch (name) {
    case _SC_NPROCESSORS_CONF: return "_SC_NPROCESSORS_CONF";
    case _SC_NPROCESSORS_ONLN: return "_SC_NPROCESSORS_ONLN";
    case _SC_PHYS_PAGES: return "_SC_PHYS_PAGES";
    case _SC_AVPHYS_PAGES: return "_SC_AVPHYS_PAGES";
    default: return nullptr;  // nearly equal on all machines
  }
}

int fail(int error) {
  errno = error;
  return -1;
}

/// Copies a text into a caller's buffer. 0, or an error number if there is no room for it.
int give(const char* text, char* to, size_t size, int too_long) {
  if (strlen(text) >= size) return too_long;
  strcpy(to, text);
  return 0;
}

/// A struct passwd with its texts one after the other in `texts`; 0 or ERANGE.
int make_user(const Machine& machine, uid_t user, passwd& entry, char* texts, size_t size) {
  char name[32];
  machine.name("user-", name, sizeof name);
  const int length = snprintf(texts, size, "%s%cx%c/home/%s%c/bin/sh", name, 0, 0, name, 0);
  if (length < 0 || static_cast<size_t>(length) >= size) return ERANGE;
  entry = {};
  entry.pw_uid = user;
  entry.pw_gid = user;
  entry.pw_name = texts;
  entry.pw_gecos = entry.pw_name;
  entry.pw_passwd = entry.pw_name + strlen(entry.pw_name) + 1;
  entry.pw_dir = entry.pw_passwd + strlen(entry.pw_passwd) + 1;
  entry.pw_shell = entry.pw_dir + strlen(entry.pw_dir) + 1;
  return 0;
}

int fill_processors(const Machine& machine, size_t size, void* set) {
  const size_t needed = static_cast<size_t>(machine.processors() + 7) / 8;
  if (size < needed) return EINVAL;
  memset(set, 0, size);
  for (int i = 0; i < machine.processors(); ++i) static_cast<unsigned char*>(set)[i / 8] |= 1 << (i % 8);
  return 0;
}

}  // namespace

bool is_machine_file(const char* path) {
  static constexpr const char* names[] = {"/proc/loadavg", "/etc/hostname", "/proc/sys/kernel/hostname"};
  for (const char* known : names)
    if (path && strcmp(path, known) == 0) return true;
  return false;
}

int open_machine_file(int number, const char* path) {
  const Machine machine{number};
  char text[128];
  machine.name("machine-", text, sizeof text - 1);
  strcat(text, "\n");
  if (strcmp(path, "/proc/loadavg") == 0) {
    // No printf() of doubles, because it depends on the locale.
    const int hundredths = static_cast<int>(machine.load() * 100.0);
    snprintf(text, sizeof text, "%d.%02d %d.%02d %d.%02d 1/%d %d\n", hundredths / 100, hundredths % 100,
             hundredths / 100, hundredths % 100, hundredths / 100, hundredths % 100, 100 * number, 1000 * number);
  }
  const Busy busy;
  const int file = memfd_create("machine", 0);
  if (file < 0) return file;
  const size_t length = strlen(text);
  if (write(file, text, length) != static_cast<ssize_t>(length)) return file;
  lseek(file, 0, SEEK_SET);
  return file;
}

// NOLINTBEGIN(bugprone-macro-parentheses): a list of arguments has its own

/// A query of the machine: it is logged. For an imaginary machine the last arguments answer it. They can use `machine`.
#define REHEARSE_ASKED(result, name, parameters, arguments, text, ...)            \
  REHEARSE_ANSWERED(machine, result, name, parameters, arguments, text,           \
                    [[maybe_unused]] const Machine machine{substitution.machine}; \
                    __VA_ARGS__)

REHEARSE_ASKED(int, get_nprocs, (), (), "", return machine.processors();)
REHEARSE_ASKED(int, get_nprocs_conf, (), (), "", return machine.processors();)
REHEARSE_ASKED(int, sched_getaffinity, (pid_t process, size_t size, void* set), (process, size, set), "", {
  const int error = fill_processors(machine, size, set);
  return error ? fail(error) : 0;
})
REHEARSE_ASKED(int, pthread_getaffinity_np, (pthread_t thread, size_t size, void* set), (thread, size, set), "",
               return fill_processors(machine, size, set);)
// Threads can't be bound to processors that don't exist; binding only affects the speed.
REHEARSE_ASKED(int, sched_setaffinity, (pid_t process, size_t size, const void* set), (process, size, set), "",
               return 0;)
REHEARSE_ASKED(int, pthread_setaffinity_np, (pthread_t thread, size_t size, const void* set), (thread, size, set), "",
               return 0;)
REHEARSE_ASKED(int, sched_getcpu, (), (), "", return machine.processors() - 1;)
REHEARSE_ASKED(int, getcpu, (unsigned* processor, unsigned* node), (processor, node), "", {
  if (processor) *processor = static_cast<unsigned>(machine.processors()) - 1;
  if (node) *node = 0;
  return 0;
})

REHEARSE_ASKED(int, gethostname, (char* to, size_t size), (to, size), "", {
  char name[32];
  machine.name("machine-", name, sizeof name);
  const int error = give(name, to, size, ENAMETOOLONG);
  return error ? fail(error) : 0;
})
REHEARSE_ASKED(int, uname, (utsname * names), (names), "", {
  if (next_uname.get()(names) != 0) return -1;
  machine.name("machine-", names->nodename, sizeof names->nodename);
  machine.name("6.0-", names->release, sizeof names->release);
  machine.name("build-", names->version, sizeof names->version);
  return 0;
})
REHEARSE_ASKED(long, gethostid, (), (), "", return 0x1234500L + machine.number;)

REHEARSE_ASKED(int, getloadavg, (double* to, int count), (to, count), "", {
  const int given = count < 3 ? count : 3;
  for (int i = 0; i < given; ++i) to[i] = machine.load() / (1 + i);
  return given;
})
REHEARSE_ASKED(int, sysinfo, (struct sysinfo * answer), (answer), "", {
  *answer = {};
  answer->uptime = 100'000L * machine.number;
  for (auto& load : answer->loads) load = static_cast<unsigned long>(machine.load() * 65536.0);
  answer->totalram = static_cast<unsigned long>(machine.gibibytes()) << 30;
  answer->freeram = answer->totalram / 2;
  answer->procs = static_cast<unsigned short>(100 * machine.number);
  answer->mem_unit = 1;
  return 0;
})

REHEARSE_INTERPOSED(long, sysconf, (int name)) {
  const char* query = name_of_query(name);
  if (!watching() || !query) return next_sysconf.get()(name);
  const Caller caller = note(source_of::sysconf, "sysconf", query, __builtin_return_address(0));
  const Machine machine{substitution_for(caller).machine};
  if (machine.number == 0) return next_sysconf.get()(name);
  if (name == _SC_NPROCESSORS_CONF || name == _SC_NPROCESSORS_ONLN) return machine.processors();
  return machine.gibibytes() * ((1L << 30) / getpagesize()) / (name == _SC_PHYS_PAGES ? 1 : 2);
}

// The terminal of stdin, stdout and stderr. Other descriptors are unchanged.
#define REHEARSE_ASKED_OF_TERMINAL(result, name, parameters, arguments, answer)                    \
  REHEARSE_INTERPOSED(result, name, parameters) {                                                  \
    if (!watching() || file < 0 || file > 2) return next_##name.get() arguments;                   \
    const Caller caller = note(source_of::name, #name, Digits(file), __builtin_return_address(0)); \
    const Machine machine{substitution_for(caller).machine};                                       \
    if (machine.number == 0) return next_##name.get() arguments;                                   \
    answer                                                                                         \
  }
REHEARSE_ASKED_OF_TERMINAL(int, isatty, (int file), (file), {
  if (machine.has_terminal()) return 1;
  errno = ENOTTY;
  return 0;
})
REHEARSE_ASKED_OF_TERMINAL(int, ttyname_r, (int file, char* to, size_t size), (file, to, size), {
  char name[32];
  machine.name("/dev/pts/", name, sizeof name);
  return machine.has_terminal() ? give(name, to, size, ERANGE) : ENOTTY;
})
REHEARSE_ASKED_OF_TERMINAL(char*, ttyname, (int file), (file), {
  static char name[32];
  machine.name("/dev/pts/", name, sizeof name);
  errno = ENOTTY;
  return machine.has_terminal() ? name : nullptr;
})

REHEARSE_INTERPOSED(int, ioctl, (int file, unsigned long request, void* argument)) {
  const bool asks = request == TIOCGWINSZ || request == TCGETS;
  if (!watching() || !asks || file < 0 || file > 2) return next_ioctl.get()(file, request, argument);
  const Caller caller =
      note(source_of::ioctl, "ioctl", request == TIOCGWINSZ ? "TIOCGWINSZ" : "TCGETS", __builtin_return_address(0));
  const Machine machine{substitution_for(caller).machine};
  if (machine.number == 0) return next_ioctl.get()(file, request, argument);
  if (!machine.has_terminal()) return fail(ENOTTY);
  if (request != TIOCGWINSZ) return next_ioctl.get()(file, request, argument);
  *static_cast<winsize*>(argument) = machine.terminal();
  return 0;
}

REHEARSE_ASKED(uid_t, getuid, (), (), "", return machine.user();)
REHEARSE_ASKED(uid_t, geteuid, (), (), "", return machine.user();)
REHEARSE_ASKED(gid_t, getgid, (), (), "", return machine.user();)
REHEARSE_ASKED(gid_t, getegid, (), (), "", return machine.user();)
REHEARSE_ASKED(char*, getlogin, (), (), "", {
  static char name[32];
  machine.name("user-", name, sizeof name);
  return name;
})
REHEARSE_ASKED(int, getlogin_r, (char* to, size_t size), (to, size), "", {
  char name[32];
  machine.name("user-", name, sizeof name);
  return give(name, to, size, ERANGE);
})
REHEARSE_ASKED(passwd*, getpwuid, (uid_t user), (user), "", {
  static passwd entry;
  static char texts[128];
  return make_user(machine, user, entry, texts, sizeof texts) == 0 ? &entry : nullptr;
})
REHEARSE_ASKED(int, getpwuid_r, (uid_t user, passwd* entry, char* texts, size_t size, passwd** result),
               (user, entry, texts, size, result), "", {
                 const int error = make_user(machine, user, *entry, texts, size);
                 *result = error ? nullptr : entry;
                 return error;
               })
REHEARSE_ASKED(pid_t, getppid, (), (), "", return 1000 * machine.number;)
REHEARSE_ASKED(int, getpriority, (int which, id_t who), (which, who), "", return machine.number;)
REHEARSE_ASKED(int, getrlimit, (int resource, rlimit* limit), (resource, limit), Digits(resource), {
  const rlim_t amount = static_cast<rlim_t>(machine.number) << 20;
  *limit = {amount, amount};
  return 0;
})
REHEARSE_ASKED(int, getrlimit64, (int resource, rlimit64* limit), (resource, limit), Digits(resource), {
  const rlim64_t amount = static_cast<rlim64_t>(machine.number) << 20;
  *limit = {amount, amount};
  return 0;
})
#undef REHEARSE_ASKED_OF_TERMINAL
#undef REHEARSE_ASKED
// NOLINTEND(bugprone-macro-parentheses)

}  // namespace rehearse::interposer
