// A controller that does a hostile or clumsy deed in its 13th call of control(), named by its options: see `deeds`.
// After the name may stand a file, for those that damage the recording.
#undef NDEBUG  // one deed is a failing assertion
#include <cnoid/SimpleController>

#include <linux/seccomp.h>
#include <sched.h>
#include <setjmp.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cassert>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>

namespace {

/// A system call that no replacement of a function of the C library sees.
long raw(long number, long first = 0, long second = 0, long third = 0, long fourth = 0) {
#if defined(__x86_64__)
  long result = 0;
  register long r10 asm("r10") = fourth;
  asm volatile("syscall"
               : "=a"(result)
               : "a"(number), "D"(first), "S"(second), "d"(third), "r"(r10)
               : "rcx", "r11", "memory");
  return result;
#else
  return syscall(number, first, second, third, fourth);
#endif
}

volatile bool forever = true;
volatile int sum = 0;

void spin() {
  while (forever) sum = sum + 1;
}

/// Uses the heap, so that damage of it shows.
void use_heap() {
  for (int i = 0; i < 1000; ++i) {
    volatile char* block = static_cast<char*>(std::malloc(static_cast<std::size_t>(i) * 7 + 1));
    block[0] = 1;
  }
}

void overrun(std::size_t allocated, std::size_t written) {
  char* volatile block = static_cast<char*>(std::malloc(allocated));
  std::memset(block, 'A', written);
  use_heap();
}

int recurse(volatile char* above) {
  volatile char here[4096];
  here[0] = above[0];
  return forever ? recurse(here) + here[0] : 0;
}

struct ThrowsWhenDestroyed {
  ~ThrowsWhenDestroyed() { throw std::runtime_error("no destructor may throw"); }
};

struct SpinsWhenDestroyed {
  bool does = false;
  ~SpinsWhenDestroyed() {
    if (does) spin();
  }
} spins_at_unload;

void crash() {
  volatile int* volatile nowhere = nullptr;
  *nowhere = 1;
}

/// Writes over the whole heap, then crashes in its own code: the C library can't go on, and neither can the host.
void crash_without_heap() {
  unsigned long begin = 0, end = 0;
  {
    std::ifstream maps("/proc/self/maps");
    for (std::string line; std::getline(maps, line);)
      if (line.find("[heap]") != std::string::npos) std::sscanf(line.c_str(), "%lx-%lx", &begin, &end);
  }
  std::memset(reinterpret_cast<void*>(begin), 'A', end - begin);
  crash();
}

void own_handlers() {
  static char stack[1 << 16];
  stack_t alternate{};
  alternate.ss_sp = stack;
  alternate.ss_size = sizeof stack;
  sigaltstack(&alternate, nullptr);
  struct {  // as the kernel reads it
    void (*handler)(int);
    unsigned long flags = 0x04000000 | SA_ONSTACK;
    void (*restorer)() = nullptr;
    unsigned long mask = 0;
  } action{[](int) { spin(); }};
  raw(SYS_rt_sigaction, SIGSEGV, reinterpret_cast<long>(&action), 0, sizeof action.mask);
  crash();
}

void fill_a_pipe() {
  int ends[2];
  if (pipe(ends) != 0) return;
  for (char byte = 0;;) static_cast<void>(!write(ends[1], &byte, 1));
}

void deadlock() {
  pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
  pthread_mutex_lock(&mutex);
  pthread_mutex_lock(&mutex);
}

/// Writes over all memory that this process shares with others.
void scribble_over_shared_memory() {
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    unsigned long begin = 0, end = 0;
    char rights[5] = {};
    if (std::sscanf(line.c_str(), "%lx-%lx %4s", &begin, &end, rights) != 3) continue;
    if (std::string(rights) == "rw-s") std::memset(reinterpret_cast<void*>(begin), 0x5a, end - begin);
  }
}

/// The soft limit: the hard one can't be raised again, by nobody but the administrator.
void set_limit(int resource, unsigned long value) {
  unsigned long limit[2] = {};
  raw(SYS_prlimit64, 0, resource, 0, reinterpret_cast<long>(limit));
  limit[0] = value;
  raw(SYS_prlimit64, 0, resource, reinterpret_cast<long>(limit), 0);
}

void fork_many() {
  for (int i = 0; i < 50; ++i)
    if (raw(SYS_clone, SIGCHLD) == 0) {
      timespec hour{3600, 0};
      raw(SYS_nanosleep, reinterpret_cast<long>(&hour));
      raw(SYS_exit, 0);
    }
}

void start_threads(int count) {
  for (int i = 0; i < count; ++i) std::thread([] { std::this_thread::sleep_for(std::chrono::hours(1)); }).detach();
}

void use_much_memory() {
  for (;;) {
    constexpr std::size_t size = 16 << 20;
    std::memset(std::malloc(size), 1, size);
  }
}

void dup_over_everything() {
  const long null = raw(SYS_open, reinterpret_cast<long>("/dev/null"), O_RDWR, 0);
  for (long i = 0; i < 100; ++i)
    if (i != null) raw(SYS_dup2, null, i);
}

jmp_buf before_control;

const std::map<std::string, void (*)(const std::string& file)> deeds{
    {"nothing", [](const auto&) {}},
    // the heap
    {"overrun_8", [](const auto&) { overrun(24, 40); }},
    {"overrun_2000", [](const auto&) { overrun(4000, 6000); }},
    {"overrun_large", [](const auto&) { overrun(100, 1 << 22); }},
    {"crash_without_heap", [](const auto&) { crash_without_heap(); }},
    {"double_free",
     [](const auto&) {
       void* volatile block = std::malloc(64);
       std::free(block);
       std::free(block);
     }},
    {"free_of_stack",
     [](const auto&) {
       char text[64] = {};
       void* volatile block = text + 8;
       std::free(block);
     }},
    {"use_after_free",
     [](const auto&) {
       for (int i = 0; i < 100; ++i) {
         char* volatile block = static_cast<char*>(std::malloc(64));
         std::free(block);
         std::memset(block, 0x41, 64);
         use_heap();
       }
     }},
    {"wild_write", [](const auto&) { std::memset(const_cast<char*>("constant"), 0, 8); }},
    {"null", [](const auto&) { crash(); }},
    {"null_to_strlen",
     [](const auto&) {
       const char* volatile nothing = nullptr;
       sum = static_cast<int>(std::strlen(nothing));
     }},
    {"read_terminal",
     [](const auto&) {
       char word[16] = {};
       if (read(STDIN_FILENO, word, sizeof word - 1) > 0 && word[0] == 'g') return;
       std::abort();
     }},
    {"million_allocations",
     [](const auto&) {
       std::vector<void*> all;
       for (int i = 0; i < 1000000; ++i) all.push_back(std::malloc(16));
       for (void* one : all) std::free(one);
     }},
    {"all_memory", [](const auto&) { use_much_memory(); }},
    {"unmap_stack_end",
     [](const auto&) {
       volatile char here = 0;
       const auto page = reinterpret_cast<unsigned long>(&here) & ~0xfffUL;
       raw(SYS_munmap, static_cast<long>(page), 0x1000);
       sum = here;
     }},
    {"shared_memory", [](const auto&) { scribble_over_shared_memory(); }},
    // the stack and the end of a call
    {"recursion",
     [](const auto&) {
       volatile char here = 0;
       recurse(&here);
     }},
    {"longjmp", [](const auto&) { longjmp(before_control, 1); }},
    {"throw", [](const auto&) { throw std::runtime_error("no gait"); }},
    {"throw_number", [](const auto&) { throw 5; }},
    {"terminate_in_destructor", [](const auto&) { ThrowsWhenDestroyed thrower; }},
    {"assert", [](const auto&) { assert(!"reachable"); }},
    {"abort", [](const auto&) { std::abort(); }},
    {"illegal_instruction", [](const auto&) { __builtin_trap(); }},
    {"division",
     [](const auto&) {
       volatile int zero = 0;
       sum = (sum + 7) / zero;
     }},
    // the process
    {"exit", [](const auto&) { std::exit(0); }},
    {"quick_exit", [](const auto&) { std::quick_exit(0); }},
    {"raw_exit", [](const auto&) { raw(SYS_exit_group, 0); }},
    {"raw_exit_in_thread", [](const auto&) { std::thread([] { raw(SYS_exit_group, 0); }).join(); }},
    {"raw_exec",
     [](const auto&) {
       const char* const words[] = {"true", nullptr};
       raw(SYS_execve, reinterpret_cast<long>("/bin/true"), reinterpret_cast<long>(words),
           reinterpret_cast<long>(words + 1));
     }},
    {"kill", [](const auto&) { kill(getpid(), SIGKILL); }},
    {"term_group", [](const auto&) { kill(0, SIGTERM); }},
    {"kill_group", [](const auto&) { kill(0, SIGKILL); }},
    {"stop", [](const auto&) { kill(getpid(), SIGSTOP); }},
    {"stop_group", [](const auto&) { kill(0, SIGSTOP); }},
    {"stop_parent", [](const auto&) { kill(getppid(), SIGSTOP); }},
    {"attach_to_parent", [](const auto&) { ptrace(PTRACE_ATTACH, getppid(), nullptr, nullptr); }},
    {"traced", [](const auto&) { ptrace(PTRACE_TRACEME, 0, nullptr, nullptr); }},
    {"traced_and_stopped",
     [](const auto&) {
       ptrace(PTRACE_TRACEME, 0, nullptr, nullptr);
       raise(SIGSTOP);
     }},
    {"strict_seccomp",
     [](const auto&) {
       prctl(PR_SET_SECCOMP, SECCOMP_MODE_STRICT);
       raw(SYS_getpid);
     }},
    {"no_memory_limit",
     [](const auto&) {
       set_limit(RLIMIT_AS, 1 << 20);
       for (int i = 0; i < 100; ++i) {
         char* volatile block = new char[1 << 20];
         block[0] = 1;
       }
     }},
    {"no_descriptors", [](const auto&) { set_limit(RLIMIT_NOFILE, 0); }},
    {"no_file_size", [](const auto&) { set_limit(RLIMIT_FSIZE, 0); }},
    {"fork_many", [](const auto&) { fork_many(); }},
    {"fork_and_return", [](const auto&) { raw(SYS_clone, SIGCHLD); }},
    // time
    {"spin", [](const auto&) { spin(); }},
    {"sleep", [](const auto&) { sleep(3600); }},
    {"deadlock", [](const auto&) { deadlock(); }},
    {"full_pipe", [](const auto&) { fill_a_pipe(); }},
    {"print_forever",
     [](const auto&) {
       while (forever) std::printf(" ");
     }},
    {"block_and_spin",
     [](const auto&) {
       const unsigned long all = ~0UL;
       raw(SYS_rt_sigprocmask, SIG_BLOCK, reinterpret_cast<long>(&all), 0, sizeof all);
       spin();
     }},
    {"allocate_forever",
     [](const auto&) {
       while (forever) std::free(std::malloc(100));
     }},
    {"own_handlers", [](const auto&) { own_handlers(); }},
    {"timer",
     [](const auto&) {
       const itimerval soon{{0, 0}, {0, 20000}};
       setitimer(ITIMER_REAL, &soon, nullptr);
       spin();
     }},
    {"spin_at_unload", [](const auto&) { spins_at_unload.does = true; }},
    // threads
    {"threads", [](const auto&) { start_threads(1000); }},
    {"thread_crash", [](const auto&) { std::thread(crash).join(); }},
    {"thread_abort", [](const auto&) { std::thread([] { assert(!"reachable"); }).join(); }},
    {"thread_overrun", [](const auto&) { std::thread([] { overrun(4000, 6000); }).join(); }},
    {"thread_throw", [](const auto&) { std::thread([] { throw std::runtime_error("no map"); }).join(); }},
    // descriptors and the recording
    {"close_all", [](const auto&) { raw(SYS_close_range, 0, ~0L, 0); }},
    {"dup_over_everything", [](const auto&) { dup_over_everything(); }},
    {"unlink_trace", [](const auto& file) { std::filesystem::remove(file); }},
    {"cut_trace",
     [](const auto& file) {
       usleep(200000);  // until the recorder has written something
       std::filesystem::resize_file(file, 100);
     }},
    {"replace_trace",
     [](const auto& file) {
       std::filesystem::remove(file);
       std::ofstream(file) << "mine";
     }},
    {"write_into_trace",
     [](const auto& file) {
       usleep(200000);
       std::fstream trace(file);
       trace.seekp(200);
       trace << "mine";
     }},
};

class Guest : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    std::istringstream words(io->optionString());
    words >> deed_ >> file_;
    joint_ = io->body()->joint(0);
    joint_->setActuationMode(cnoid::Link::JointTorque);
    io->enableIO(joint_);
    if (deeds.count(deed_) == 0 && deed_ != "spin_in_destructor") io->os() << "no such deed: " << deed_ << std::endl;
    setjmp(before_control);
    return deeds.count(deed_) > 0 || deed_ == "spin_in_destructor";
  }
  ~Guest() override {
    if (deed_ == "spin_in_destructor") spin();
  }

  bool control() override {
    joint_->u() = -1.0 * joint_->q();
    if (calls_++ == 12 && deeds.count(deed_) > 0) deeds.at(deed_)(file_);
    return true;
  }

 private:
  std::string deed_, file_;
  int calls_ = 0;
  cnoid::Link* joint_ = nullptr;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Guest)
