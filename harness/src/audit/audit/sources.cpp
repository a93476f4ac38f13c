// The system functions whose answers aren't inputs of a controller.
#include "library_scan.h"

namespace rehearse {
namespace {

using Source = ObservedCall::Source;

struct FunctionGroup {
  Source source;
  std::string_view names;  // each between spaces
};

constexpr FunctionGroup functions[] = {
    {Source::clock,
     " alarm clock clock_gettime clock_nanosleep ftime getrusage gettimeofday nanosleep poll pthread_cond_clockwait "
     "pthread_cond_timedwait pthread_mutex_clocklock pthread_mutex_timedlock select sem_clockwait sem_timedwait "
     "setitimer sleep time timer_create timerfd_create times timespec_get usleep "},
    {Source::random,
     " arc4random arc4random_buf arc4random_uniform drand48 getentropy getrandom initstate lcong48 lrand48 mrand48 "
     "rand random seed48 srand srand48 srandom "},
    {Source::thread,
     " clone execv execve execvp fork popen posix_spawn posix_spawnp pthread_create system thrd_create vfork "},
    {Source::file,
     " __open64_2 __open_2 __openat64_2 __openat_2 access chmod creat creat64 faccessat fchmodat fdopendir fopen "
     "fopen64 freopen freopen64 fstatat fstatat64 fts64_open fts_open ftw ftw64 getdents64 glob glob64 lstat "
     "lstat64 mkdir mkdtemp mkostemp mkstemp mkstemp64 mq_open msgget nftw nftw64 open open64 openat openat64 "
     "opendir readlink readlinkat realpath remove rename rmdir scandir scandir64 scandirat scandirat64 semget shm_open "
     "shm_unlink shmat shmget stat stat64 statfs statfs64 statvfs statvfs64 statx tmpfile tmpfile64 truncate unlink "
     "unlinkat utimensat wordexp "},
    {Source::network, " bind connect getaddrinfo gethostbyname getifaddrs socket "},
    {Source::environment,
     " clearenv environ get_current_dir_name get_nprocs get_nprocs_conf getauxval getcpu getcwd getegid getenv geteuid "
     "getgid gethostid gethostname getloadavg getlogin getlogin_r getpid getppid getpriority getpwuid getpwuid_r "
     "getrlimit getrlimit64 gettid getuid ioctl isatty localtime localtime_r mktime pthread_getaffinity_np "
     "pthread_setaffinity_np putenv sched_getaffinity sched_getcpu sched_setaffinity secure_getenv setenv sysconf "
     "sysinfo ttyname ttyname_r tzset uname unsetenv "},
    {Source::locale, " __newlocale localeconv newlocale setlocale uselocale "},
    {Source::process,
     " _Exit _exit abort chdir close_range closefrom dlopen exit fchdir kill pthread_sigmask quick_exit raise "
     "sigaction signal sigprocmask syscall umask "},
};

/// Sources in the C++ library: by the prefix of the mangled name, because a class has many members.
struct Member {
  std::string_view beginning;
  Source source;
  std::string_view name;
};

constexpr Member members[] = {
    {"_ZNSt6chrono3_V212system_clock3now", Source::clock, "std::chrono::system_clock::now"},
    {"_ZNSt6chrono3_V212steady_clock3now", Source::clock, "std::chrono::steady_clock::now"},
    {"_ZNSt13random_device", Source::random, "std::random_device"},
    {"_ZNSt6thread15_M_start_thread", Source::thread, "std::thread"},
    {"_ZNSt6thread20hardware_concurrency", Source::environment, "std::thread::hardware_concurrency"},
    {"_ZNSt14basic_ifstream", Source::file, "std::fstream"},
    {"_ZNSt14basic_ofstream", Source::file, "std::fstream"},
    {"_ZNSt13basic_fstream", Source::file, "std::fstream"},
    {"_ZNSt13basic_filebuf", Source::file, "std::fstream"},
    {"_ZNSt10filesystem", Source::file, "std::filesystem"},
    {"_ZNSt6localeC1EPKc", Source::locale, "std::locale(name)"},
    {"_ZNSt6localeC2EPKc", Source::locale, "std::locale(name)"},
    {"_ZNSt6locale6global", Source::locale, "std::locale::global"},
};

/// A path is only a name; it doesn't access the file.
constexpr std::string_view paths = "_ZNSt10filesystem7__cxx114path";

}  // namespace

std::optional<SymbolSource> source_of_symbol(std::string_view symbol) {
  const std::string word = " " + std::string(symbol) + " ";
  for (const FunctionGroup& group : functions)
    if (group.names.find(word) != std::string_view::npos) return SymbolSource{group.source, std::string(symbol)};
  if (symbol.starts_with(paths)) return std::nullopt;
  for (const Member& member : members)
    if (symbol.starts_with(member.beginning)) return SymbolSource{member.source, std::string(member.name)};
  return std::nullopt;
}

}  // namespace rehearse
