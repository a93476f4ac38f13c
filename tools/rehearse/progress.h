// A progress bar on stderr, for people only: if stderr is a terminal and no debugger uses it, and once the work has taken a
// second.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>

namespace rehearse::tool {

class Progress {
 public:
  /// `what` stands before the bar: "recording". `parts`: how often the work counts from 0 to all; the bar takes each for as
  /// long as the others.
  explicit Progress(std::string what, int parts = 1);
  /// Takes the bar away.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(std::int64_t done, std::int64_t all);

 private:
  using Clock = std::chrono::steady_clock;
  std::string what_;
  bool on_terminal_;
  int parts_;
  int part_ = 0;               // that is under way
  std::int64_t done_ = 0;      // of it
  bool drawn_ = false;
  Clock::time_point begin_ = Clock::now();
  Clock::time_point last_ = begin_;
};

/// Thrown by StoppableProgress.
struct Interrupted {};

/// Of work that is no run: SIGINT and SIGTERM end it at its next count by an exception, which run_verb() takes; objects on
/// the way remove what was begun. The same signal again, a second later, ends the process at once.
class StoppableProgress : public Progress {
 public:
  explicit StoppableProgress(std::string what);
  void show(std::int64_t done, std::int64_t all);
};

/// True if what is written there is read by a person: then it is its own progress bar.
bool is_terminal(std::FILE* stream);

/// Wall time since it was made [s].
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point begin_ = Clock::now();
};

}  // namespace rehearse::tool
