// Controllers that change their process.

#include <fcntl.h>
#include <fenv.h>
#include <pthread.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <thread>

#include "behaviours.h"

namespace behaviours {
namespace {

std::atomic<bool> may_end{false};

void wait_for_end() {
  while (!may_end) usleep(1000);
}

void on_signal(int) {}

void handle(int number, sighandler_t handler) {
  struct sigaction action {};
  action.sa_handler = handler;
  sigaction(number, &action, nullptr);
}

void block(int number) {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, number);
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

void set_timer() {
  const itimerval soon{{0, 0}, {3600, 0}};
  setitimer(ITIMER_REAL, &soon, nullptr);
}

void close_all() {
  for (int descriptor = 3; descriptor < 1024; ++descriptor) close(descriptor);
}

/// Opens a file, which gets the descriptor number of a closed file.
void write_own_file() {
  const int own = open("own.txt", O_CREAT | O_WRONLY | O_TRUNC, 0644);
  static_cast<void>(write(own, "mine", 4));
}

void close_behind_the_library() {
  for (int descriptor = 3; descriptor < 1024; ++descriptor) syscall(SYS_close, descriptor);
}

const std::map<std::string, void (*)()>& deeds() {
  static const std::map<std::string, void (*)()> all{
      {"chdir", [] { static_cast<void>(chdir("/")); }},
      {"current_path", [] { std::filesystem::current_path("/"); }},
      {"handler", [] { handle(SIGUSR1, on_signal); }},
      {"ignore", [] { signal(SIGPIPE, SIG_IGN); }},
      {"own_segv", [] { handle(SIGSEGV, on_signal), handle(SIGABRT, SIG_IGN); }},
      {"block", [] { block(SIGTERM); }},
      {"alarm", [] { alarm(3600); }},
      {"timer", set_timer},
      {"locale", [] { std::setlocale(LC_NUMERIC, "C.UTF-8"); }},
      {"environment", [] { setenv("REHEARSE_TEST_TRESPASS", "1", 1); }},
      {"umask", [] { umask(0); }},
      {"close", close_all},
      {"close_range", [] { close_range(3, ~0U, 0); }},
      {"close_open", [] { close_all(), write_own_file(); }},
      {"close_raw", [] { close_behind_the_library(), write_own_file(); }},
      {"stdout", [] { std::fclose(stdout), dup2(2, 1); }},
      {"round", [] { fesetround(FE_UPWARD); }},
      {"trap", [] { feenableexcept(FE_DIVBYZERO | FE_INVALID); }},
      {"thread_exit", [] { std::thread([] { std::exit(0); }).detach(), usleep(50000); }},
  };
  return all;
}

/// trespass DEED FUNCTION [TICK]: commands 1 N·m, and does DEED in initialize, start, stop or that tick of control.
class Trespasser : public Pusher {
 public:
  explicit Trespasser(const Words& words)
      : Pusher(1.0),
        deed_(deeds().at(words.at(0))),
        where_(words.at(1)),
        when_(words.size() > 2 ? std::stoi(words[2]) : 0) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    Pusher::initialize(io);
    return do_in("initialize");
  }
  bool start() override { return do_in("start"); }
  bool control() override {
    const bool now = tick_ >= when_;
    Pusher::control();
    return now ? do_in("control") : true;
  }
  void stop() override { do_in("stop"); }

 private:
  bool do_in(const std::string& function) {
    if (function == where_) deed_();
    return true;
  }
  void (*deed_)();
  std::string where_;
  int when_;
};
const Add<Trespasser> trespasser("trespass");

/// Starts a thread in start(); "joined" joins it in stop(), "left" doesn't, "late" requests its end without joining.
class ThreadOwner : public Pusher {
 public:
  explicit ThreadOwner(const Words& words) : Pusher(1.0), how_(words.at(0)) {}
  bool start() override {
    may_end = false;
    thread_ = std::thread(wait_for_end);
    return true;
  }
  void stop() override {
    if (how_ != "left") may_end = true;
    if (how_ == "joined") return thread_.join();
    thread_.detach();
  }

 private:
  std::string how_;
  std::thread thread_;
};
const Add<ThreadOwner> thread_owner("thread");

/// Ends the threads that other controllers have left running.
class Ender : public Pusher {
 public:
  explicit Ender(const Words&) : Pusher(0.0) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    may_end = true;
    return Pusher::initialize(io);
  }
};
const Add<Ender> ender("end_threads");

}  // namespace
}  // namespace behaviours
