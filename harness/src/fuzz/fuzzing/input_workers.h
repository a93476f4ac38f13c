// InputWorkers: makes runs in worker processes, as many at a time as there are workers. Internal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "core/guard/worker_pool.h"
#include "input_run.h"

namespace rehearse {

class InputWorkers {
 public:
  /// Fails if the controller can't be loaded or fails in a run with all inputs at their starts, or if an expectation
  /// has a mistake. The setup must outlive this.
  static Result<std::unique_ptr<InputWorkers>> create(const FuzzSetup& setup, std::size_t workers);
  ~InputWorkers();
  InputWorkers(const InputWorkers&) = delete;
  InputWorkers& operator=(const InputWorkers&) = delete;

  static constexpr std::size_t most_at_once = 64;

  /// The outcomes of the runs, in their order. Fails if no process can be started, or if a signal interrupts it.
  Result<std::vector<InputOutcome>> run(const std::vector<Inputs>& all, MemoryFill fill = MemoryFill::large_numbers);
  /// Makes one run in a new process and records it.
  Result<InputOutcome> record(const Inputs& inputs, const std::filesystem::path& file);

  const Claims& claims() const { return *parts_.claims; }

 private:
  struct Shared;
  InputWorkers(const FuzzSetup& setup, std::vector<NamedSeries> series, std::size_t workers);
  WorkerPool::Made make(std::int64_t job);
  Result<void> run_part(const std::vector<Inputs>& all, MemoryFill fill, std::size_t first, std::size_t count,
                        std::vector<InputOutcome>& outcomes);
  Result<void> wait_for_answers(std::vector<std::pair<std::size_t, std::size_t>>& lost, std::size_t jobs,
                                std::size_t offset, std::vector<InputOutcome>& outcomes);

  const FuzzSetup& setup_;
  RunParts parts_;
  std::size_t workers_;
  std::size_t slot_size_ = 0;  // numbers of a run
  Shared* shared_ = nullptr;
  std::size_t shared_bytes_ = 0;
  std::unique_ptr<WorkerPool> pool_;
};

}  // namespace rehearse
