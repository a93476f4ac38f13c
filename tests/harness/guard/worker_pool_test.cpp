// WorkerPool: how many processes many jobs take, what becomes of answers and output, and workers that end.
#include "core/guard/worker_pool.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

namespace rehearse {
namespace {

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
    if (auto answer = pool.wait()) answers[answer->job] = *std::move(answer);
  }
  return answers;
}

class WorkerPoolOf : public ::testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Kinds, WorkerPoolOf, ::testing::Values(Kind::bare, Kind::supervised));

TEST_P(WorkerPoolOf, ManyJobsTakeAsManyProcessesAsThereAreWorkers) {
  WorkerPool pool({.kind = GetParam(), .size = 2},
                  [](std::int64_t job, const auto&) { return std::to_string(job) + " " + std::to_string(getpid()); });
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
                  [&](std::int64_t job, const auto&) { return job == 0 ? std::string() : longest; });
  const Answers answers = all_of(pool, 2);
  EXPECT_EQ(answers.at(0).text, "");
  EXPECT_TRUE(answers.at(1).text == longest);
}

TEST_P(WorkerPoolOf, AWorkerThatEndsIsReplaced) {
  WorkerPool pool({.kind = GetParam()}, [](std::int64_t job, const auto&) {
    if (job == 1) std::raise(SIGKILL);
    if (job == 2) std::_Exit(7);
    return std::to_string(job);
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

TEST_P(WorkerPoolOf, ARenewedWorkerIsAnotherProcess) {
  WorkerPool pool({.kind = GetParam()}, [](std::int64_t, const auto&) { return std::to_string(getpid()); });
  const auto first = all_of(pool, 1).at(0).text;
  EXPECT_EQ(all_of(pool, 1).at(0).text, first);
  pool.renew(0);
  EXPECT_NE(all_of(pool, 1).at(0).text, first);
  EXPECT_EQ(pool.started(), 2);
}

TEST(SupervisedWorker, KeepsTheOutputOfEachJob) {
  WorkerPool pool({.kind = Kind::supervised, .size = 2}, [](std::int64_t job, const auto&) {
    if (job % 2 == 0) std::printf("out %d\n", static_cast<int>(job));
    if (job % 3 == 0) std::fprintf(stderr, "errors %d\n", static_cast<int>(job));
    return std::string();
  });
  for (const auto& [job, answer] : all_of(pool, 30)) {
    EXPECT_EQ(answer.out, job % 2 == 0 ? "out " + std::to_string(job) + "\n" : "");
    EXPECT_EQ(answer.errors, job % 3 == 0 ? "errors " + std::to_string(job) + "\n" : "");
  }
}

TEST(SupervisedWorker, KeepsTheOutputOfAJobThatEndsIt) {
  WorkerPool pool({.kind = Kind::supervised}, [](std::int64_t, const auto&) -> std::string {
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
    return std::string();
  });
  all_of(pool, 1);
  EXPECT_EQ(pool.renew(0).status, 3);
}

TEST(BareWorker, ThatTakesTooLongIsKilled) {
  WorkerPool pool({.kind = Kind::bare, .limits = {.time = 0.1}}, [](std::int64_t, const auto&) {
    pause();
    return std::string();
  });
  const Answers answers = all_of(pool, 1);
  EXPECT_EQ(answers.at(0).exceeded, WorkerPool::Answer::Limit::time);
}

}  // namespace
}  // namespace rehearse
