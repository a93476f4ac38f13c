// WorkerPool: processes that do many jobs each. Internal.
#pragma once

#include <rehearse/diagnostic.h>
#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

/// The workers are forks of this process, made when a job needs them. They end with this process, even if it is killed.
/// Their output is discarded.
class WorkerPool {
 public:
  /// Makes a job, in a worker, and returns its answer. `folder`: of this worker alone.
  using Work = std::function<std::string(std::int64_t job, const std::filesystem::path& folder)>;

  /// The end of a job.
  struct Answer {
    std::int64_t job = 0;
    std::filesystem::path folder;     // of its worker, which doesn't use it until the next job
    std::optional<std::string> text;  // none: the worker ended
    enum class Limit { time, memory };
    std::optional<Limit> exceeded;  // it was killed for that
    std::string end;                // how the worker ended: "by SIGKILL", "with exit status 1"
  };

  /// Of a job.
  struct Limits {
    double time = 0.0;    // wall time [s]
    double memory = 0.0;  // memory of its worker [bytes]; 0: four fifths of the memory that is available now
  };
  WorkerPool(std::size_t size, const Limits& limits, std::filesystem::path folder, Work work);
  /// Kills the workers.
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  bool is_idle() const;   // no worker has a job
  bool has_room() const;  // a worker has no job
  /// Gives the job to a worker without one. Fails if no process can be started.
  Result<void> give(std::int64_t job);
  /// The next answer; none: there was none for some tenths of a second.
  std::optional<Answer> wait();
  /// The next job of the worker in that folder is made by a new process.
  void renew(const std::filesystem::path& folder);
  /// As renew(), for all workers; none may have a job.
  void renew_all();

 private:
  using Clock = std::chrono::steady_clock;
  struct Worker {
    pid_t process = 0;  // 0: none
    int socket = -1;
    std::filesystem::path folder;
    std::optional<std::int64_t> job;
    Clock::time_point since{};
  };
  Result<void> start(Worker& worker);
  [[noreturn]] void serve(int socket, const std::filesystem::path& folder) const;
  static std::string stop(Worker& worker, bool is_ending);
  Answer end_of(Worker& worker, std::optional<Answer::Limit> exceeded);

  const Limits limits_;
  const Work work_;
  std::vector<Worker> workers_;
};

}  // namespace rehearse
