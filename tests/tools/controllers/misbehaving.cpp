// A controller that does what its options say, as "crash 12": what, and in which call of control(); without a number in
// initialize(). Knows: refuse, throw, throw_long, throw_nowhere, crash, abort, exit, close, overflow, print, hang,
// leak, nan, complain, chance, slow (each call takes 0.2 s), unread (reads an input that it never enabled);
// say-and-DEED: writes a line in initialize() and does DEED; and what ends the process past the C library, see
// past_the_library().
#include <cmath>
#include <cnoid/SimpleController>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>

#include <signal.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <thread>

namespace {

void spin() {
  for (volatile bool forever = true; forever;) {
  }
}

/// 3 MB with control characters.
std::string long_text() {
  std::string text = "no \x1b[31mgait\nat ";
  for (int i = 0; i < 300000; ++i) text += "\x1b]0;slope\a";
  return text;
}

[[noreturn, gnu::noinline]] void throw_long_text() { throw std::runtime_error(long_text()); }

void throw_nowhere() noexcept { throw_long_text(); }

/// A system call as a library of one's own would make it.
long system_call(long number, long first = 0, long second = 0, long third = 0, long fourth = 0) {
  long result = 0;
#if defined(__x86_64__)
  register long r10 asm("r10") = fourth;
  asm volatile("syscall"
               : "=a"(result)
               : "a"(number), "D"(first), "S"(second), "d"(third), "r"(r10)
               : "rcx", "r11", "memory");
#else
  result = syscall(number, first, second, third, fourth);
#endif
  return result;
}

/// 200 bytes into an array of 16.
[[gnu::noinline]] void overrun(volatile std::size_t size) {
  char small[16];
  std::memset(small, 0x5a, size);
  asm volatile("" : : "r"(small) : "memory");
}

void null_write() {
  volatile int* volatile nowhere = nullptr;
  *nowhere = 1;
}

/// The C library writes through it.
void copy_to_null() {
  char* volatile nowhere = nullptr;
  const char source[64] = {};
  volatile std::size_t size = sizeof source;
  std::memcpy(nowhere, source, size);
  asm volatile("" : : : "memory");
}

/// The C library reads through it.
void measure_null() {
  char* volatile nowhere = nullptr;
  volatile std::size_t length = std::strlen(nowhere);
  static_cast<void>(length);
}

/// In the C library; a signal that is handled doesn't end it.
void wait_for_ever() {
  int ends[2];
  char nothing = 0;
  if (pipe(ends) == 0) static_cast<void>(!read(ends[0], &nothing, 1));
}

/// 50 MB in each hundredth of a second, up to 4 GB.
void leak() {
  constexpr std::size_t size = 50'000'000;
  for (int i = 0; i < 80; ++i, usleep(10000)) {
    void* volatile block = std::malloc(size);
    std::memset(block, 1, size);
  }
}

void set_timer_and_wait() {
  const itimerval soon{{0, 0}, {0, 20000}};
  setitimer(ITIMER_REAL, &soon, nullptr);
  spin();
}

void block_and_spin() {
  const unsigned long all = ~0UL;
  system_call(SYS_rt_sigprocmask, SIG_BLOCK, reinterpret_cast<long>(&all), 0, sizeof all);
  spin();
}

volatile bool deeper = true;

/// Recurses without end; the compiler can neither know that nor turn it into a loop.
int sink(volatile char* above) {
  volatile char here[4096];
  here[0] = above[0];
  return deeper ? sink(here) + here[0] : 0;
}

void overflow_stack() {
  volatile char bottom = 0;
  sink(&bottom);
}

/// Follows a null pointer with 4 MB of the stack in use, half of it.
int crash_deep(int depth, volatile char* above) {
  volatile char here[4096];
  here[0] = above[0];
  if (depth == 0) return *static_cast<volatile int*>(nullptr);
  return crash_deep(depth - 1, here) + here[0];
}

void past_the_library(const std::string& deed) {
  if (deed == "exit_group") system_call(SYS_exit_group, 0);
  if (deed == "syscall_exit") syscall(SYS_exit_group, 0);
  if (deed == "execl") execl("/bin/true", "true", nullptr);
  if (deed == "raw_exec") {
    const char* const words[] = {"true", nullptr};
    system_call(SYS_execve, reinterpret_cast<long>("/bin/true"), reinterpret_cast<long>(words),
                reinterpret_cast<long>(words + 1));
  }
  if (deed == "kill") kill(getpid(), SIGKILL);
  if (deed == "memcpy_null") copy_to_null();
  if (deed == "strlen_null") measure_null();
  if (deed == "term") kill(getpid(), SIGTERM);
  if (deed == "overrun") overrun(200);
  if (deed == "thread_crash") std::thread(null_write).join();
  if (deed == "thread_overflow") std::thread(overflow_stack).join();
  if (deed == "crash_deep") {
    volatile char bottom = 0;
    crash_deep(1000, &bottom);
  }
  if (deed == "own_pipe") {
    int ends[2];
    if (pipe(ends) == 0) close(ends[0]), static_cast<void>(!write(ends[1], "x", 1));
  }
  if (deed == "thread_throw") std::thread([] { throw std::runtime_error("no map"); }).join();
  if (deed == "thread_throw_long") std::thread([] { throw std::runtime_error(long_text()); }).join();
  if (deed == "thread_exit_group") std::thread([] { system_call(SYS_exit_group, 0); }).join();
  if (deed == "detached_crash") std::thread(null_write).detach();
  if (deed == "timer") set_timer_and_wait();
  if (deed == "block_and_hang") block_and_spin();
  if (deed == "file_limit") {  // and waits, so that a background writer exceeds the limit
    const rlimit none{0, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &none);
    usleep(50000);
  }
  if (deed == "raw_close") system_call(SYS_close_range, 0, ~0L, 0);
  if (deed == "fork") fork();
  if (deed == "raw_fork") system_call(SYS_clone, SIGCHLD);
  if (deed == "syscall_clone") syscall(SYS_clone, SIGCHLD, 0, 0, 0, 0);
  if (deed == "vfork") static_cast<void>(vfork());
  if (deed == "fork_and_spin" && fork() == 0) spin();
  if (deed == "fork_and_exit") {
    const pid_t child = fork();
    if (child == 0) _exit(7);
    int status = 0;
    waitpid(child, &status, 0);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 7) std::abort();
  }
}

class Misbehaving : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io_ = io;
    std::istringstream words(io->optionString());
    words >> deed_;
    if (!(words >> when_)) when_ = -1;
    joint_ = io->body()->joint(0);
    joint_->setActuationMode(cnoid::Link::JointTorque);
    io->enableIO(joint_);
    if (deed_.rfind("say-and-", 0) == 0) {
      io->os() << "the robot has no joint KNEE" << std::endl;
      deed_ = deed_.substr(std::strlen("say-and-"));
    }
    if (when_ < 0) misbehave();
    return deed_ != "refuse";
  }

  bool control() override {
    joint_->u() = -1.0 * joint_->q();
    if (deed_ == "unread") joint_->u() = -1.0 * joint_->dq();
    if (deed_ == "slow") usleep(200000);
    if (deed_ == "chat") io_->os() << "call " << calls_ << std::endl;
    if (calls_++ == when_) misbehave();
    return true;
  }

 private:
  void misbehave() {
    if (deed_ == "throw") throw std::runtime_error("no gait for this slope");
    if (deed_ == "throw_long") throw std::runtime_error(long_text());
    if (deed_ == "throw_nowhere") throw_nowhere();
    if (deed_ == "words_long") io_->os() << long_text() << std::endl, throw 5;
    if (deed_ == "crash") missing_->u() = 1.0;
    if (deed_ == "abort") std::abort();
    if (deed_ == "exit") std::exit(0);
    if (deed_ == "close")
      for (int descriptor = 1; descriptor < 1024; ++descriptor) close(descriptor);
    if (deed_ == "nan") joint_->u() = std::nan("");
    if (deed_ == "complain") io_->os() << "[ERROR] no map" << std::endl;
    if (deed_ == "chance") joint_->u() = 1e-9 * std::random_device()();
    if (deed_ == "overflow") overflow_stack();
    if (deed_ == "print") std::printf("%s\n", std::string(10000, 'x').c_str());
    if (deed_ == "hang") spin();
    if (deed_ == "wait") wait_for_ever();
    if (deed_ == "leak") leak();
    past_the_library(deed_);
  }

  std::string deed_;
  int when_ = -1;
  int calls_ = 0;
  cnoid::SimpleControllerIO* io_ = nullptr;
  cnoid::Link* joint_ = nullptr;
  cnoid::Link* volatile missing_ = nullptr;  // as for a misspelt name without a check
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Misbehaving)
