// Own processes: each call in a process of its own, its answer, and calls that end their process.
#include "core/guard/own_process.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>

#include "core/guard/guarded_call.h"
#include "core/guard/process_end.h"
#include "core/guard/worker_pool.h"

namespace rehearse {
namespace {

/// The end of a worker with a supervisor that does this.
WorkerPool::Answer supervised(const std::function<std::string()>& work) {
  WorkerPool pool({.kind = WorkerPool::Kind::supervised}, [&](std::int64_t, const auto&) {
    begin_own_processes();
    return WorkerPool::Made{work(), false};
  });
  EXPECT_TRUE(pool.give(0).ok());
  for (;;) {
    auto answer = pool.wait();
    EXPECT_TRUE(answer.ok());
    if (!answer) return {};
    if (*answer) return **std::move(answer);
  }
}

std::string text_of(const Result<std::string>& answer) { return answer ? *answer : to_string(answer.errors()); }

TEST(OwnProcess, HasEachCall) {
  const auto answer = supervised([] {
    static int calls = 0;
    const pid_t here = getpid();
    std::string all;
    for (int i = 0; i < 3; ++i)
      all +=
          text_of(call_in_own_process([here] { return std::to_string(++calls) + (getpid() == here ? "here " : " "); }));
    return all + std::to_string(calls);
  });
  EXPECT_EQ(answer.text, "1 1 1 0") << answer.end << answer.errors;
}

TEST(OwnProcess, PassesAnAnswerOfAnySize) {
  const std::string longest(5'000'001, 'x');
  for (const std::string& text : {std::string(), longest}) {
    const auto answer = supervised([&] { return text_of(call_in_own_process([&] { return text; })); });
    EXPECT_TRUE(answer.text == text);
  }
}

TEST(OwnProcess, PassesAnException) {
  const auto answer = supervised([]() -> std::string {
    try {
      static_cast<void>(call_in_own_process([]() -> std::string { throw std::runtime_error("no room"); }));
    } catch (const std::runtime_error& problem) {
      return std::to_string(getpid() == getpid()) + problem.what();
    }
    return "nothing";
  });
  EXPECT_EQ(answer.text, "1no room");
}

TEST(OwnProcess, PrintsNothingTwice) {
  const auto answer = supervised([] {
    std::printf("before ");
    static_cast<void>(call_in_own_process([] {
      std::printf("within ");
      return std::string();
    }));
    std::printf("after");
    return std::string();
  });
  EXPECT_EQ(answer.out, "before within after");
}

TEST(OwnProcess, LeavesNoDescriptorAndNoProcess) {
  const auto answer = supervised([] {
    const auto descriptors = [] {
      const std::filesystem::directory_iterator all("/proc/self/fd");
      return std::distance(begin(all), end(all));
    };
    const auto call = [] { static_cast<void>(call_in_own_process([] { return std::string("made"); })); };
    call();
    const auto before = descriptors();
    for (int i = 0; i < 20; ++i) call();
    const bool has_children = waitpid(-1, nullptr, WNOHANG) >= 0;
    return std::string(before == descriptors() ? "equal" : "more") + (has_children ? ", children" : "");
  });
  EXPECT_EQ(answer.text, "equal");
}

TEST(OwnProcess, EndsThisProcessInItsWay) {
  const auto killed = supervised([] {
    return text_of(call_in_own_process([]() -> std::string {
      std::raise(SIGKILL);
      return "";
    }));
  });
  EXPECT_EQ(killed.text, std::nullopt);
  EXPECT_EQ(killed.end, "by SIGKILL");
  const auto left = supervised([] { return text_of(call_in_own_process([]() -> std::string { std::_Exit(7); })); });
  EXPECT_EQ(left.text, std::nullopt);
  EXPECT_EQ(left.end, "with exit status 7");
}

TEST(OwnProcess, EndsWithThisProcess) {
  const std::string file =
      (std::filesystem::path(::testing::TempDir()) / ("rehearse_own_" + std::to_string(getpid()))).string();
  const auto answer = supervised([&] {
    const pid_t here = getpid();
    return text_of(call_in_own_process([&]() -> std::string {
      std::ofstream(file) << getpid() << std::endl;
      kill(here, SIGKILL);
      for (;;) pause();
    }));
  });
  EXPECT_EQ(answer.end, "by SIGKILL");
  pid_t own = 0;
  std::ifstream(file) >> own;
  ASSERT_GT(own, 0);
  for (int i = 0; i < 1000 && kill(own, 0) == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_NE(kill(own, 0), 0);
  std::filesystem::remove(file);
}

TEST(OwnProcess, BeginsWithoutGuestsUntilThisOneLoadsOne) {
  const auto answer = supervised([] {
    std::string told = begin_without_guests() ? "without" : "with";
    static_cast<void>(call_in_own_process([] {
      note_own_libraries();  // as in the loading of a controller
      return std::string();
    }));
    told += begin_without_guests() ? " without" : " with";
    note_own_libraries();
    return told + (begin_without_guests() ? " without" : " with");
  });
  EXPECT_EQ(answer.text, "without without with");
}

TEST(OwnProcess, IsThisOneWithoutASupervisor) {
  begin_own_processes();
  EXPECT_FALSE(has_own_processes());
  EXPECT_EQ(text_of(call_in_own_process([] { return std::to_string(getpid()); })), std::to_string(getpid()));
}

/// The number of times that the other threads of this process have slept.
long sleeps_of_other_threads() {
  long sum = 0;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task")) {
    if (thread.path().filename() == std::to_string(getpid())) continue;
    std::ifstream facts(thread.path() / "status");
    for (std::string word; facts >> word;)
      if (long count = 0; word == "voluntary_ctxt_switches:" && facts >> count) sum += count;
  }
  return sum;
}

// In a process of its own: the watchdog's thread stays, and a process that is forked beside it has no leak check.
TEST(WatchdogDeathTest, SleepsWhileNoCallIsMade) {
  const auto sleeps_and_wakes = [] {
    guarded_call([] {}, 10.0);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    const long before = sleeps_of_other_threads();
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    std::fprintf(stderr, "slept %ld times", sleeps_of_other_threads() - before);
    const CallOutcome hung = guarded_call(
        [] {
          for (;;) pause();
        },
        0.1);
    std::_Exit(hung.end == CallEnd::hung ? 0 : 1);
  };
  EXPECT_EXIT(sleeps_and_wakes(), ::testing::ExitedWithCode(0), "^slept 0 times");
}

}  // namespace
}  // namespace rehearse
