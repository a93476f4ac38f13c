// A controller whose library stays in memory, unless IS_UNLOADED: the static object is destroyed by exit(). Its options
// say what that object does then: nothing, print, join (a worker that waits for ever), spin, block (spins with all
// signals blocked), crash, abort, throw, exit, raw_exit, kill, leak (in the first call of control()).
#include <cnoid/SimpleController>

#include <signal.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>

/// A pool of one worker, which waits for work.
class Pool {
 public:
  void start() {
    worker_ = std::thread([this] { work(); });
  }
  void misbehave_at_end(const std::string& deed) { deed_ = deed; }
  ~Pool() {
    if (deed_ == "print") std::puts("the pool is destroyed");
    if (deed_ == "spin") spin();
    if (deed_ == "block") {
      const unsigned long all = ~0UL;
      syscall(SYS_rt_sigprocmask, SIG_BLOCK, &all, nullptr, sizeof all);
      spin();
    }
    if (deed_ == "crash") *static_cast<volatile int*>(nullptr) = 1;
    if (deed_ == "abort") std::abort();
    if (deed_ == "throw") fail();
    if (deed_ == "exit") _exit(5);
    if (deed_ == "raw_exit") syscall_past_the_library(SYS_exit_group, 5);
    if (deed_ == "kill") kill(getpid(), SIGKILL);
    if (worker_.joinable()) worker_.join();
  }

 private:
  static void fail() { throw std::runtime_error("the pool is \x1b[31mbusy"); }
  static void spin() {
    for (volatile bool forever = true; forever;) {
    }
  }
  static void syscall_past_the_library(long number, long argument) {
#if defined(__x86_64__)
    long result = 0;
    asm volatile("syscall" : "=a"(result) : "a"(number), "D"(argument) : "rcx", "r11", "memory");
#else
    syscall(number, argument);
#endif
  }
  void work() {
    std::unique_lock lock(mutex_);
    for (;;) has_work_.wait(lock);
  }

  std::string deed_;
  std::mutex mutex_;
  std::condition_variable has_work_;
  std::thread worker_;
};

#ifdef IS_UNLOADED
static Pool pool;
#else
inline Pool pool;  // gcc makes it a unique symbol, and the dynamic linker unloads no library that has one
#endif

namespace {

class Stays : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    deed_ = io->optionString();
    hinge_ = io->body()->joint(0);
    hinge_->setActuationMode(cnoid::Link::JointEffort);
    io->enableIO(hinge_);
    if (deed_ == "join") pool.start();
    pool.misbehave_at_end(deed_);
    return true;
  }
  bool control() override {
    hinge_->u() = -1.0 * hinge_->q();
    if (deed_ == "leak") lost_ = new int[1000];
    if (deed_ == "leak") deed_.clear();
    lost_ = nullptr;
    return true;
  }

 private:
  std::string deed_;
  cnoid::Link* hinge_ = nullptr;
  int* volatile lost_ = nullptr;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Stays)
