// WorkerPool: processes that do many jobs each. Internal.
#pragma once

#include <rehearse/diagnostic.h>
#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "model/file_descriptor.h"

namespace rehearse {

/// The workers are forks of this process, made when a job needs them. They end with this process, even if it is killed.
class WorkerPool {
 public:
  /// Makes a job, in a worker, and returns its answer. `folder`: of this worker alone.
  using Work = std::function<std::string(std::int64_t job, const std::filesystem::path& folder)>;

  /// The end of a job.
  struct Answer {
    std::int64_t job = 0;
    std::size_t worker = 0;           // its index
    std::filesystem::path folder;     // of its worker, which doesn't use it until the next job
    std::optional<std::string> text;  // none: the worker ended
    enum class Limit { time, memory };
    std::optional<Limit> exceeded;  // it was killed for that
    std::string end;                // how the worker ended: "by SIGKILL", "with exit status 1"
    int status = 0;                 // exit status of the worker, 128 + n if signal n ended it
    std::string out, errors;        // what a supervised worker wrote to stdout and stderr during the job
  };

  /// Of a job.
  struct Limits {
    double time = std::numeric_limits<double>::infinity();  // wall time [s]
    double memory = 0.0;  // memory of its worker [bytes]; 0: four fifths of the memory that is available now
  };

  enum class Kind {
    bare,       // ignores signals; its output is discarded; the pool kills it
    supervised  // has a supervisor; signals end its run; its output is kept; the pool asks it to end
  };
  struct Setup {
    Kind kind = Kind::bare;
    std::size_t size = 1;               // number of workers
    Limits limits = {};                 // of bare workers; supervisors have limits of their own
    std::filesystem::path folder = {};  // for the folders of the workers; empty: they have none
  };
  /// Supervised workers: this process must not have threads.
  WorkerPool(Setup setup, Work work);
  /// Ends the workers: those with a job, too.
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  bool is_idle() const;   // no worker has a job
  bool has_room() const;  // a worker has no job
  /// Gives the job to a worker without one. Fails if no process can be started.
  Result<void> give(std::int64_t job);
  /// The next answer; none: there was none for some tenths of a second, or a signal came.
  std::optional<Answer> wait();
  /// The next job of that worker, which has none, is made by a new process. Returns how the present one ended.
  Answer renew(std::size_t worker);
  /// As renew(), for all workers, which end at the same time. None of them has a job.
  std::vector<Answer> renew_all();
  /// Sends the signal to all workers.
  void tell(int signal) const;
  /// The number of workers that were started.
  std::int64_t started() const { return started_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Worker {
    pid_t process = 0;  // 0: none
    int socket = -1;
    std::filesystem::path folder;
    std::optional<std::int64_t> job;
    Clock::time_point since{};
    std::string received;  // a part of an answer
    FileDescriptor out, errors;
  };
  enum class Ending { has_closed, is_asked, is_killed };
  Result<void> start(Worker& worker);
  void prepare(const Worker& worker, int socket) const;
  [[noreturn]] void serve(int socket, const std::filesystem::path& folder) const noexcept;
  static void ask_to_end(Worker& worker);
  Answer stop(Worker& worker, Ending ending) const;
  Answer end_of(Worker& worker, std::optional<Answer::Limit> exceeded);
  Answer answer_of(Worker& worker) const;

  const Setup setup_;
  const Work work_;
  std::vector<Worker> workers_;
  std::int64_t started_ = 0;
};

}  // namespace rehearse
