// WorkerPool: how many processes many jobs take, what becomes of answers and output, and workers that end.
#include "core/guard/worker_pool.h"

#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {
namespace {

namespace fs = std::filesystem;

using Kind = WorkerPool::Kind;
using Answers = std::map<std::int64_t, WorkerPool::Answer>;

/// Gives the jobs 0 to `count` - 1, and waits for their ends.
Answers all_of(WorkerPool& pool, std::int64_t count) {
  Answers answers;
  for (std::int64_t next = 0; std::ssize(answers) < count;) {
    while (next < count && pool.has_room()) {
      const auto given = pool.give(next++);
      EXPECT_TRUE(given.ok());
      if (!given) return answers;
    }
    auto answer = pool.wait();
    EXPECT_TRUE(answer.ok());
    if (!answer) return answers;
    if (*answer) answers[(*answer)->job] = **std::move(answer);
  }
  return answers;
}

WorkerPool::Made made(std::string text, bool spoils_process = false) { return {std::move(text), spoils_process}; }

class WorkerPoolOf : public ::testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Kinds, WorkerPoolOf, ::testing::Values(Kind::bare, Kind::supervised));

TEST_P(WorkerPoolOf, ManyJobsTakeAsManyProcessesAsThereAreWorkers) {
  WorkerPool pool({.kind = GetParam(), .size = 2}, [](std::int64_t job, const auto&) {
    return made(std::to_string(job) + " " + std::to_string(getpid()));
  });
  std::set<std::string> processes;
  for (const auto& [job, answer] : all_of(pool, 100)) {
    const std::string begin = std::to_string(job) + " ";
    ASSERT_TRUE(answer.text && answer.text->starts_with(begin)) << answer.end;
    processes.insert(answer.text->substr(begin.size()));
  }
  EXPECT_EQ(pool.started(), 2);
  EXPECT_LE(processes.size(), 2U);
  EXPECT_TRUE(pool.is_idle());
}

TEST_P(WorkerPoolOf, AnAnswerMayHaveAnySize) {
  const std::string longest(5'000'001, 'x');
  WorkerPool pool({.kind = GetParam()},
                  [&](std::int64_t job, const auto&) { return made(job == 0 ? std::string() : longest); });
  const Answers answers = all_of(pool, 2);
  EXPECT_EQ(answers.at(0).text, "");
  EXPECT_TRUE(answers.at(1).text == longest);
}

TEST_P(WorkerPoolOf, AWorkerThatEndsIsReplaced) {
  WorkerPool pool({.kind = GetParam()}, [](std::int64_t job, const auto&) {
    if (job == 1) std::raise(SIGKILL);
    if (job == 2) std::_Exit(7);
    return made(std::to_string(job));
  });
  const Answers answers = all_of(pool, 4);
  EXPECT_EQ(answers.at(0).text, "0");
  EXPECT_EQ(answers.at(1).text, std::nullopt);
  EXPECT_EQ(answers.at(1).end, "by SIGKILL");
  EXPECT_EQ(answers.at(1).status, 128 + SIGKILL);
  EXPECT_EQ(answers.at(2).end, "with exit status 7");
  EXPECT_EQ(answers.at(2).status, 7);
  EXPECT_EQ(answers.at(3).text, "3");
  EXPECT_EQ(pool.started(), 3);
}

TEST_P(WorkerPoolOf, RenewedWorkersAreOtherProcesses) {
  WorkerPool pool({.kind = GetParam()}, [](std::int64_t, const auto&) { return made(std::to_string(getpid())); });
  const auto first = all_of(pool, 1).at(0).text;
  EXPECT_EQ(all_of(pool, 1).at(0).text, first);
  EXPECT_EQ(pool.renew_all().size(), 1U);
  EXPECT_NE(all_of(pool, 1).at(0).text, first);
  EXPECT_EQ(pool.started(), 2);
}

TEST_P(WorkerPoolOf, AJobThatSpoilsItsProcessIsItsLast) {
  WorkerPool pool({.kind = GetParam()},
                  [](std::int64_t job, const auto&) { return made(std::to_string(getpid()), job == 1); });
  const Answers answers = all_of(pool, 4);
  EXPECT_EQ(answers.at(0).text, answers.at(1).text);
  EXPECT_NE(answers.at(1).text, answers.at(2).text);
  EXPECT_EQ(answers.at(2).text, answers.at(3).text);
  EXPECT_EQ(pool.started(), 2);
}

TEST_P(WorkerPoolOf, AWorkerTakesItsNextJobBeforeItsAnswerIsRead) {
  const fs::path folder = fs::path(::testing::TempDir()) / ("rehearse_pool_" + std::to_string(getpid()));
  WorkerPool pool({.kind = GetParam(), .folder = folder}, [&](std::int64_t job, const fs::path& own) {
    std::ofstream(folder / ("begun-" + std::to_string(job))) << own.string();
    return made(own.string());
  });
  std::int64_t given = 0;
  while (pool.has_room()) ASSERT_TRUE(pool.give(given++).ok());
  EXPECT_EQ(given, 4);
  while (!fs::exists(folder / "begun-3")) usleep(1000);  // no answer is read yet
  std::set<std::string> folders;
  for (std::int64_t job = 0; job < given; ++job) {
    const auto answer = pool.wait();
    ASSERT_TRUE(answer.ok() && *answer);
    EXPECT_EQ((*answer)->job, job);
    folders.insert((*answer)->text.value_or(""));
  }
  EXPECT_EQ(std::ssize(folders), given) << "each job has a folder of its own";
  EXPECT_TRUE(pool.is_idle());
  fs::remove_all(folder);
}

/// Nobody waits for a job that a busy worker would have next.
TEST_P(WorkerPoolOf, AFreeWorkerTakesTheJobThatIsNext) {
  const fs::path folder = fs::path(::testing::TempDir()) / ("rehearse_pool_" + std::to_string(getpid()));
  fs::create_directories(folder);
  WorkerPool pool({.kind = GetParam(), .size = 2}, [&](std::int64_t job, const auto&) {
    while (job == 0 && !fs::exists(folder / "others")) usleep(1000);
    return made(std::to_string(job));
  });
  for (std::int64_t job = 0; job < 4; ++job) ASSERT_TRUE(pool.give(job).ok());
  std::vector<std::int64_t> order;
  while (order.size() < 4) {
    const auto answer = pool.wait();
    ASSERT_TRUE(answer.ok());
    if (*answer) order.push_back((*answer)->job);
    if (order.size() == 3) std::ofstream(folder / "others") << "made";
  }
  EXPECT_EQ(order, (std::vector<std::int64_t>{1, 2, 3, 0}));
  fs::remove_all(folder);
}

TEST_P(WorkerPoolOf, TheJobAfterTheLastOfAWorkerIsMadeByAnother) {
  WorkerPool pool({.kind = GetParam()}, [](std::int64_t job, const auto&) {
    if (job == 0) std::raise(SIGKILL);
    return made(std::to_string(job));
  });
  ASSERT_TRUE(pool.give(0).ok() && pool.give(1).ok());  // both before the first one ends
  Answers answers;
  while (!pool.is_idle()) {
    auto answer = pool.wait();
    ASSERT_TRUE(answer.ok());
    if (*answer) answers[(*answer)->job] = **std::move(answer);
  }
  EXPECT_EQ(answers.at(0).end, "by SIGKILL");
  EXPECT_EQ(answers.at(1).text, "1");
}

TEST_P(WorkerPoolOf, AnIdleWorkerEndsWithTheProcessOfItsPoolEvenIfThatIsKilled) {
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);  // orphans become children of this process
  int ends[2] = {};
  ASSERT_EQ(::pipe(ends), 0);
  const pid_t process = fork();
  if (process == 0) {
    WorkerPool pool({.kind = GetParam()}, [](std::int64_t, const auto&) { return made(std::to_string(getpid())); });
    const std::string worker = all_of(pool, 1).at(0).text.value_or("");
    const bool is_told = ::write(ends[1], worker.data(), worker.size()) == std::ssize(worker);
    kill(getpid(), is_told ? SIGKILL : SIGTERM);
  }
  ::close(ends[1]);
  char text[16] = {};
  ASSERT_GT(::read(ends[0], text, sizeof text - 1), 0);
  ::close(ends[0]);
  int status = 0;
  ASSERT_EQ(waitpid(process, &status, 0), process);
  EXPECT_EQ(WTERMSIG(status), SIGKILL);
  const auto worker = static_cast<pid_t>(std::stoi(text));
  const auto is_there = [worker] {
    while (waitpid(-1, nullptr, WNOHANG) > 0) continue;
    return kill(worker, 0) == 0;
  };
  for (int i = 0; i < 1000 && is_there(); ++i) usleep(10'000);
  EXPECT_FALSE(is_there());
}

TEST(SupervisedWorker, KeepsTheOutputOfEachJob) {
  WorkerPool pool({.kind = Kind::supervised, .size = 2}, [](std::int64_t job, const auto&) {
    if (job % 2 == 0) std::printf("out %d\n", static_cast<int>(job));
    if (job % 3 == 0) std::fprintf(stderr, "errors %d\n", static_cast<int>(job));
    return made("");
  });
  for (const auto& [job, answer] : all_of(pool, 30)) {
    EXPECT_EQ(answer.out, job % 2 == 0 ? "out " + std::to_string(job) + "\n" : "");
    EXPECT_EQ(answer.errors, job % 3 == 0 ? "errors " + std::to_string(job) + "\n" : "");
  }
}

TEST(SupervisedWorker, KeepsTheOutputOfAJobThatEndsIt) {
  WorkerPool pool({.kind = Kind::supervised}, [](std::int64_t, const auto&) -> WorkerPool::Made {
    std::fputs("it can't be read\n", stderr);
    std::exit(2);
  });
  const Answers answers = all_of(pool, 1);
  EXPECT_EQ(answers.at(0).status, 2);
  EXPECT_EQ(answers.at(0).errors, "it can't be read\n");
}

TEST(SupervisedWorker, EndsWhenItIsAskedTo) {
  WorkerPool pool({.kind = Kind::supervised}, [](std::int64_t, const auto&) {
    std::atexit([] { std::_Exit(3); });  // as a library whose static object fails
    return made("");
  });
  all_of(pool, 1);
  const auto ends = pool.renew_all();
  ASSERT_EQ(ends.size(), 1U);
  EXPECT_EQ(ends[0].status, 3);
}

TEST(SupervisedWorker, ThatDoesNotEndWellAfterAJobThatSpoilsItFailsTheJob) {
  WorkerPool pool({.kind = Kind::supervised}, [](std::int64_t, const auto&) {
    std::atexit([] { std::_Exit(3); });
    return made("done", true);
  });
  const Answers answers = all_of(pool, 1);
  EXPECT_EQ(answers.at(0).text, std::nullopt);
  EXPECT_EQ(answers.at(0).status, 3);
}

TEST(SupervisedWorker, ThatIsKilledBetweenTwoJobsIsNotForgotten) {
  WorkerPool pool({.kind = Kind::supervised},
                  [](std::int64_t, const auto&) { return made(std::to_string(getppid())); });
  const auto supervisor = static_cast<pid_t>(std::stoi(*all_of(pool, 1).at(0).text));
  ASSERT_EQ(kill(supervisor, SIGKILL), 0);
  siginfo_t ended{};
  waitid(P_PID, static_cast<id_t>(supervisor), &ended, WEXITED | WNOWAIT);
  const auto none = pool.wait();
  EXPECT_TRUE(none.ok() && !*none);
  EXPECT_EQ(all_of(pool, 2).at(1).text.has_value(), true);
  const auto ends = pool.renew_all();
  ASSERT_EQ(ends.size(), 2U);
  EXPECT_EQ(ends[0].status, 128 + SIGKILL);
}

TEST(BareWorker, ThatTakesTooLongIsKilled) {
  WorkerPool pool({.kind = Kind::bare, .limits = {.time = 0.1}}, [](std::int64_t, const auto&) {
    pause();
    return made("");
  });
  const Answers answers = all_of(pool, 1);
  EXPECT_EQ(answers.at(0).exceeded, WorkerPool::Answer::Limit::time);
}

}  // namespace
}  // namespace rehearse
