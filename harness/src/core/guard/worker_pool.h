// WorkerPool: processes that do many jobs each. Internal.
#pragma once

#include <rehearse/diagnostic.h>
#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/file_descriptor.h"

namespace rehearse {

/// The workers are forks of this process, made when a job needs them. They end with this process, even if it is killed.
/// A worker takes the first job that no other has taken, and doesn't wait for this process before the next one.
class WorkerPool {
 public:
  /// The answer of a job.
  struct Made {
    std::string text;
    bool spoils_process = false;  // interrupted code may have left anything in memory: the worker's last job
  };
  /// Makes a job, in a worker. `folder`: of this job alone.
  using Work = std::function<Made(std::int64_t job, const std::filesystem::path& folder)>;

  /// The end of a job.
  struct Answer {
    std::int64_t job = 0;
    std::filesystem::path folder;     // of the job; the next give() may give it to another one
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
    std::filesystem::path folder = {};  // for the folders of the jobs; empty: they have none
  };
  /// Supervised workers: this process must not have threads.
  WorkerPool(Setup setup, Work work);
  /// Ends the workers: those with a job, too.
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  bool is_idle() const { return given_ == 0; }  // each job has its answer
  /// True if fewer jobs than four for each worker are without an answer: those at work, and those that are next.
  bool has_room() const { return given_ < places_.size(); }
  /// Adds a job. Fails if no process can be started.
  Result<void> give(std::int64_t job);
  /// The next answer; none: there was none for some tenths of a second, or a signal came. Fails if a worker has to be
  /// replaced, and no process can be started.
  Result<std::optional<Answer>> wait();
  /// The next jobs are made by new processes. Each job has its answer. Returns how the present ones ended, and those
  /// that ended between two jobs.
  std::vector<Answer> renew_all();
  /// Sends the signal to all workers.
  void tell(int signal) const;
  /// The number of workers that were started.
  std::int64_t started() const { return started_; }

 private:
  struct Shared;
  /// A job that has no answer yet. The same index as in the shared memory.
  struct Place {
    std::optional<std::int64_t> job;
    std::filesystem::path folder;
  };
  struct Worker {
    pid_t process = 0;  // 0: none
    int socket = -1;
    std::string received;  // answers, the last of them perhaps a part
    FileDescriptor out, errors;
  };
  enum class Ending { has_closed, is_asked, is_killed };
  Result<void> share();
  Result<void> start_missing();
  Result<void> start(Worker& worker);
  void prepare(const Worker& worker, int socket) const;
  [[noreturn]] void serve(const Worker& worker, int socket) const noexcept;
  std::size_t number_of(const Worker& worker) const { return static_cast<std::size_t>(&worker - workers_.data()); }
  std::optional<Answer> next_received(Worker& worker);
  std::optional<Answer> receive(Worker& worker);
  std::optional<std::size_t> place_of(const Worker& worker) const;
  void offer_lost_places();
  Answer take(std::size_t place);
  Answer stop(Worker& worker, Ending ending);
  std::optional<Answer> end_of(Worker& worker, std::optional<Answer::Limit> exceeded);

  const Setup setup_;
  const Work work_;
  std::vector<Worker> workers_;
  std::vector<Place> places_;
  Shared* shared_ = nullptr;
  std::size_t given_ = 0;      // jobs without an answer
  std::int64_t order_ = 0;     // of the next job
  std::vector<Answer> ended_;  // workers that ended between two jobs
  std::int64_t started_ = 0;
};

}  // namespace rehearse
