// A progress bar on stderr, for people only: if stderr is a terminal, and once the work has taken a second.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>

namespace rehearse::tool {

class Progress {
 public:
  /// `what` stands before the bar: "recording".
  explicit Progress(std::string what);
  /// Takes the bar away.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(std::int64_t done, std::int64_t all);

 private:
  using Clock = std::chrono::steady_clock;
  std::string what_;
  bool on_terminal_;
  bool drawn_ = false;
  Clock::time_point begin_ = Clock::now();
  Clock::time_point last_ = begin_;
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
