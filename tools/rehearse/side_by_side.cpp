#include "side_by_side.h"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <string_view>
#include <thread>
#include <utility>

#include "core/guard/interruption.h"
#include "core/guard/worker_pool.h"
#include "output.h"
#include "progress.h"

namespace rehearse::tool {
namespace {

using Work = std::function<Result<MadePart>(std::size_t)>;

/// In a worker, whose errors the pool's process prints, and as an object with --json.
void tell(const Diagnostics& errors) { std::fputs(to_string(errors).c_str(), stderr); }

/// Makes a part in a worker. A part that fails ends the worker.
WorkerPool::Made make(std::size_t number, const Work& work) {
  auto status = static_cast<int>(Exit::bad_input);
  try {
    auto made = work(number);
    if (made && interruption() == 0) return *std::move(made);
    if (!made) tell(made.errors());
  } catch (const Interrupted&) {
    // the status says it
  } catch (const std::exception& problem) {
    tell({error(fmt::format("internal error: {}", problem.what()))});
  }
  if (interruption() != 0) status = 128 + interruption();
  std::exit(status);
}

/// The message of the first error among printed lines.
std::string first_error_in(const std::string& lines) {
  constexpr std::string_view mark = "error: ";
  const std::size_t at = lines.find(mark);
  if (at == std::string::npos) return "a process ended without a result";
  return lines.substr(at + mark.size(), lines.find('\n', at) - at - mark.size());
}

void print_output(const WorkerPool::Answer& answer) {
  std::fputs(answer.out.c_str(), stdout);
  std::fflush(stdout);
  std::fputs(answer.errors.c_str(), stderr);
}

/// Waits for an answer, and passes a signal of this process on, once.
Result<WorkerPool::Answer> next_answer(WorkerPool& pool, int& told) {
  for (;;) {
    if (interruption() != 0 && told == 0) pool.tell(told = interruption());
    auto answer = REHEARSE_TRY(pool.wait());
    if (answer) return *std::move(answer);
  }
}

/// Ends the workers. A library may fail when it is unloaded, at the end of its process.
Exit end_of(WorkerPool& pool) {
  auto worst = static_cast<int>(Exit::done);
  for (const WorkerPool::Answer& answer : pool.renew_all()) {
    print_output(answer);
    worst = std::max(worst, answer.status);
  }
  return static_cast<Exit>(worst);
}

}  // namespace

std::size_t processors() { return std::max(1U, std::thread::hardware_concurrency()); }

Exit work_side_by_side(std::size_t count, std::size_t jobs, const Work& work,
                       const std::function<void(const std::string&)>& take) {
  keep_terminal();
  end_runs_on_signals();
  WorkerPool pool({.kind = WorkerPool::Kind::supervised, .size = std::min(jobs, count)},
                  [&](std::int64_t number, const auto&) { return make(static_cast<std::size_t>(number), work); });
  std::map<std::size_t, WorkerPool::Answer> finished;  // that wait for parts before them
  std::size_t given = 0;
  int told = 0;
  for (std::size_t next = 0; next < count;) {
    while (given < count && pool.has_room() && interruption() == 0) {
      if (const auto started = pool.give(static_cast<std::int64_t>(given)); !started) return refuse(started.errors());
      ++given;
    }
    const auto first = finished.find(next);
    if (first == finished.end()) {
      if (next == given) return Exit::done;  // a signal came before it began
      auto answer = next_answer(pool, told);
      if (!answer) return refuse(answer.errors());
      finished.emplace(static_cast<std::size_t>(answer->job), *std::move(answer));
      continue;
    }
    const WorkerPool::Answer answer = std::move(first->second);
    finished.erase(first);
    ++next;
    if (answer.text) take(*answer.text);
    print_output(answer);
    if (!answer.text) {
      if (interruption() == 0) print_errors_as_json({error(first_error_in(answer.errors))});
      return static_cast<Exit>(answer.status);
    }
  }
  return end_of(pool);
}

}  // namespace rehearse::tool
