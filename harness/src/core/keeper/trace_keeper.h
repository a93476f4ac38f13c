// TraceKeeper: writes the recordings of a child process into their files, and closes them when the child has failed.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "ring.h"

namespace rehearse {

class TraceKeeper {
 public:
  /// Starts a thread that takes what the child sends.
  explicit TraceKeeper(Ring& ring);
  ~TraceKeeper();
  TraceKeeper(const TraceKeeper&) = delete;
  TraceKeeper& operator=(const TraceKeeper&) = delete;

  /// The child has written into memory that is not its own: nothing more is taken from it.
  bool is_damaged() const { return damaged_; }
  /// Must be called when the child has ended: takes the rest, and ends the thread.
  void finish();

  /// Gives the open recordings up: they keep what was sent, and have no end.
  void drop_traces();

  /// How the child failed.
  struct Failure {
    std::string source;    // label of the controller
    std::string sentence;  // as in RunOutcome::failure
    std::int64_t tick = 0;
    double time = 0.0;  // [s]
  };
  /// Closes the open recordings, each with the failure as its last event and its outcome. Returns a line for each.
  std::vector<std::string> close_failed(const Failure& failure);

 private:
  struct Kept;
  void run();
  bool take(std::vector<std::byte>& message);

  RingReader from_child_;
  std::map<std::uint32_t, std::unique_ptr<Kept>> traces_;  // the open ones, by the number of their Writer
  std::atomic<bool> child_ended_{false};
  std::atomic<bool> damaged_{false};
  std::thread thread_;  // last member: it starts after all others are initialised
};

}  // namespace rehearse
