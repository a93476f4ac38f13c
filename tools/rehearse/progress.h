// A progress bar on stderr, for people only: if stderr is a terminal and no debugger uses it, and once the work has
// taken a second.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>

namespace rehearse::tool {

class Progress {
 public:
  /// `what` is printed before the bar: "recording". `parts`: how many times the work counts from 0 to all; each part
  /// takes the same length of the bar.
  explicit Progress(std::string what, int parts = 1);
  /// Removes the bar.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(std::int64_t done, std::int64_t all);
  /// Removes the bar until the next count: something else is printed.
  void hide();
  /// Changes the text before the bar.
  void set_text(std::string what) { what_ = std::move(what); }

 private:
  using Clock = std::chrono::steady_clock;
  /// In memory that forks of this process share: parts of the work may be done there.
  struct Shown {
    int part = 0;           // index of the current part
    std::int64_t done = 0;  // progress of the current part
    bool drawn = false;
    Clock::time_point last = {};
  };
  std::string what_;
  int parts_;
  Shown* shown_ = nullptr;  // null: no person sees it
  Clock::time_point begin_ = Clock::now();
};

/// Thrown by StoppableProgress.
struct Interrupted {};

/// Progress of work that isn't a run: SIGINT and SIGTERM end it at its next count by an exception, which run_verb()
/// catches; destructors remove incomplete files. The same signal again, a second later, ends the process at once.
class StoppableProgress : public Progress {
 public:
  explicit StoppableProgress(std::string what);
  void show(std::int64_t done, std::int64_t all);
};

/// True if the stream is a terminal, where a person reads the output: then no progress bar is needed.
bool is_terminal(std::FILE* stream);

/// Wall time since construction [s].
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point begin_ = Clock::now();
};

}  // namespace rehearse::tool
