#include "input_workers.h"

#include <fmt/format.h>
#include <sched.h>
#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <limits>
#include <utility>

#include "core/guard/interruption.h"
#include "core/guard/supervise.h"

namespace rehearse {

/// The inputs of runs, as the workers read them. After it come the numbers of all runs.
struct InputWorkers::Shared {
  MemoryFill fill = MemoryFill::large_numbers;
  std::atomic<int> started{0};  // workers
  std::int32_t ticks[most_at_once] = {};
  double* values() { return reinterpret_cast<double*>(this + 1); }
};

namespace {

/// A job: some runs, one after another.
std::int64_t job_of(std::size_t first, std::size_t count) { return static_cast<std::int64_t>(first << 16 | count); }

Diagnostic interrupted() { return error("interrupted"); }

/// The outcome of a run whose process ended in it.
InputOutcome lost_run(const FuzzSetup& setup, const WorkerPool::Answer& answer) {
  InputOutcome outcome;
  outcome.tick = 0;
  if (answer.exceeded == WorkerPool::Answer::Limit::memory) {
    outcome.end = InputEnd::took_memory;
    outcome.sentence = fmt::format("the controller took more than {:g} MB of memory", setup.plan.memory_limit);
  } else if (answer.exceeded) {
    outcome.end = InputEnd::hung;
    outcome.sentence = "the run doesn't end";
  } else {
    outcome.end = InputEnd::ended_process;
    outcome.sentence = fmt::format("the process with the controller ended {}", answer.end);
  }
  outcome.reason = without_numbers_in(outcome.sentence);
  return outcome;
}

/// The wall time of some runs in one process [s]. Each call has its own limit; this one is for what no call contains.
constexpr double longest_job = 300.0;

WorkerPool::Setup setup_of(const FuzzSetup& setup, std::size_t workers) {
  return {WorkerPool::Kind::bare, workers, {longest_job, setup.plan.memory_limit * 1e6}, {}};
}

/// Waits for the answer of the only job.
Result<WorkerPool::Answer> answer_of(WorkerPool& pool) {
  for (;;) {
    if (interruption() != 0) return interrupted();
    auto answer = REHEARSE_TRY(pool.wait());
    if (answer) return *std::move(answer);
  }
}

/// The series of the runs, by one in a process of its own.
Result<std::vector<NamedSeries>> find_series(const FuzzSetup& setup) {
  WorkerPool pool(setup_of(setup, 1), [&](std::int64_t, const std::filesystem::path&) {
    const auto series = series_of_run(setup, inputs_at_start(setup.columns, std::min(setup.plan.ticks, 16)));
    std::vector<std::pair<std::string, std::string>> found;
    if (series)
      for (const NamedSeries& one : *series) found.emplace_back(one.name, one.unit);
    const std::string why = series ? "" : series.errors().front().message;
    return WorkerPool::Made{packed(std::pair(why, found)), true};
  });
  REHEARSE_TRY(pool.give(0));
  const auto answer = REHEARSE_TRY(answer_of(pool));
  std::pair<std::string, std::vector<std::pair<std::string, std::string>>> found;
  if (!answer.text || !unpack(*answer.text, found))
    return error(fmt::format("the fuzz test {} can't run: {}", setup.plan.name, lost_run(setup, answer).sentence));
  if (!found.first.empty()) return error(found.first);
  std::vector<NamedSeries> series;
  for (auto& [name, unit] : found.second) series.push_back({std::move(name), std::move(unit)});
  return series;
}

}  // namespace

InputWorkers::InputWorkers(const FuzzSetup& setup, std::vector<NamedSeries> series, std::size_t workers)
    : setup_(setup),
      parts_{setup, RunTable(std::move(series), setup.plan.time_step), std::nullopt},
      workers_(workers) {}

InputWorkers::~InputWorkers() {
  pool_.reset();
  if (shared_) ::munmap(shared_, shared_bytes_);
}

Result<std::unique_ptr<InputWorkers>> InputWorkers::create(const FuzzSetup& setup, std::size_t workers) {
  auto series = REHEARSE_TRY(find_series(setup));
  std::unique_ptr<InputWorkers> made(
      new InputWorkers(setup, std::move(series), std::clamp<std::size_t>(workers, 1, 16)));
  auto claims = REHEARSE_TRY(Claims::parse(setup.scenario.expectations, made->parts_.table));
  made->parts_.claims.emplace(std::move(claims));
  made->slot_size_ = setup.columns.size() * static_cast<std::size_t>(setup.plan.ticks);
  made->shared_bytes_ = sizeof(Shared) + most_at_once * made->slot_size_ * sizeof(double);
  void* memory = ::mmap(nullptr, made->shared_bytes_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return error("there is no memory for the inputs of a fuzz test");
  made->shared_ = new (memory) Shared;
  InputWorkers* const self = made.get();
  made->pool_ =
      std::make_unique<WorkerPool>(setup_of(setup, made->workers_),
                                   [self](std::int64_t job, const std::filesystem::path&) { return self->make(job); });
  return made;
}

/// Keeps a worker and its threads on one processor. A run loads the controller's library and unloads it; where a thread
/// has run on another processor, each change of the process's memory interrupts that one.
static void stay_on_processor(std::atomic<int>& started) {
  static bool stays = false;
  if (std::exchange(stays, true)) return;
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (::sched_getaffinity(0, sizeof allowed, &allowed) != 0) return;
  int left = started++ % std::max(1, CPU_COUNT(&allowed));
  for (int processor = 0; processor < CPU_SETSIZE; ++processor) {
    if (!CPU_ISSET(processor, &allowed) || left-- > 0) continue;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(processor, &one);
    for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task"))
      ::sched_setaffinity(std::atoi(thread.path().filename().c_str()), sizeof one, &one);
    return;
  }
}

/// In a worker. The outcomes of the runs up to the first after which its process isn't sound.
WorkerPool::Made InputWorkers::make(std::int64_t job) {
  const auto first = static_cast<std::size_t>(job >> 16), count = static_cast<std::size_t>(job & 0xFFFF);
  stay_on_processor(shared_->started);
  keep_freed_memory();
  std::vector<InputOutcome> outcomes;
  bool spoilt = false;
  for (std::size_t i = first; i < first + count && !spoilt; ++i) {
    const double* values = shared_->values() + i * slot_size_;
    const Inputs inputs{setup_.columns.size(),
                        {values, values + static_cast<std::size_t>(shared_->ticks[i]) * setup_.columns.size()}};
    outcomes.push_back(run_inputs(parts_, inputs, shared_->fill));
    spoilt = ends_process(outcomes.back().end);
  }
  return {packed(outcomes), spoilt};
}

Result<void> InputWorkers::wait_for_answers(std::vector<std::pair<std::size_t, std::size_t>>& lost, std::size_t jobs,
                                            std::size_t offset, std::vector<InputOutcome>& outcomes) {
  while (jobs > 0) {
    if (interruption() != 0) return interrupted();
    const auto answer = REHEARSE_TRY(pool_->wait());
    if (!answer) continue;
    --jobs;
    const auto first = static_cast<std::size_t>(answer->job >> 16),
               count = static_cast<std::size_t>(answer->job & 0xFFFF);
    std::vector<InputOutcome> made;
    if (answer->text && unpack(*answer->text, made)) {
      for (std::size_t i = 0; i < made.size(); ++i) outcomes[offset + first + i] = std::move(made[i]);
      if (made.size() < count) lost.emplace_back(first + made.size(), count - made.size());
    } else if (count == 1) {
      outcomes[offset + first] = lost_run(setup_, *answer);
    } else {
      for (std::size_t i = 0; i < count; ++i) lost.emplace_back(first + i, 1);  // it isn't known in which one it ended
    }
  }
  return {};
}

Result<void> InputWorkers::run_part(const std::vector<Inputs>& all, MemoryFill fill, std::size_t first,
                                    std::size_t count, std::vector<InputOutcome>& outcomes) {
  shared_->fill = fill;
  for (std::size_t i = 0; i < count; ++i) {
    const Inputs& inputs = all[first + i];
    shared_->ticks[i] = inputs.ticks();
    std::ranges::copy(inputs.values, shared_->values() + i * slot_size_);
  }
  std::vector<std::pair<std::size_t, std::size_t>> waiting;
  const std::size_t jobs = std::min(workers_, count);
  for (std::size_t job = 0, from = 0; job < jobs; ++job) {
    const std::size_t until = count * (job + 1) / jobs;
    waiting.emplace_back(from, until - from);
    from = until;
  }
  while (!waiting.empty()) {
    std::vector<std::pair<std::size_t, std::size_t>> left;
    std::size_t given = 0;
    for (const auto& [from, runs] : waiting) {
      if (given == workers_) {
        left.emplace_back(from, runs);
        continue;
      }
      REHEARSE_TRY(pool_->give(job_of(from, runs)));
      ++given;
    }
    REHEARSE_TRY(wait_for_answers(left, given, first, outcomes));
    waiting = std::move(left);
  }
  return {};
}

Result<std::vector<InputOutcome>> InputWorkers::run(const std::vector<Inputs>& all, MemoryFill fill) {
  std::vector<InputOutcome> outcomes(all.size());
  for (std::size_t first = 0; first < all.size(); first += most_at_once)
    REHEARSE_TRY(run_part(all, fill, first, std::min(most_at_once, all.size() - first), outcomes));
  return outcomes;
}

Result<InputOutcome> InputWorkers::record(const Inputs& inputs, const std::filesystem::path& file) {
  WorkerPool pool(setup_of(setup_, 1), [&](std::int64_t, const std::filesystem::path&) {
    return WorkerPool::Made{packed(run_inputs(parts_, inputs, MemoryFill::large_numbers, file)), true};
  });
  REHEARSE_TRY(pool.give(0));
  const auto answer = REHEARSE_TRY(answer_of(pool));
  InputOutcome outcome;
  if (!answer.text || !unpack(*answer.text, outcome)) return lost_run(setup_, answer);
  return outcome;
}

}  // namespace rehearse
