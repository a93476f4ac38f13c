// TapRing: the ring of a tap, as its reader sees it. The protocol and its proof are in <rehearse/tap_ring.h>.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/file_descriptor.h"
#include "tap_definitions.h"

struct tap_ring_head;

namespace rehearse {

class TapRing {
 public:
  /// The file of the ring of a tap with that name, of this user.
  static std::filesystem::path file_of(const std::string& name);

  /// What the reader does: it takes ticks, which are then no longer counted as dropped, or it only looks.
  enum class Use : std::uint8_t { takes, looks };
  /// Opens a ring. Fails if the file is no ring of a tap, belongs to another user, is of another version, or if another
  /// process takes its ticks. Null: there is no such file, or the loop is making it.
  static Result<std::unique_ptr<TapRing>> open(const std::filesystem::path& file, Use use);
  /// The ring in this memory, which must begin at a multiple of 64 bytes and outlive the result.
  static Result<std::unique_ptr<TapRing>> of_memory(std::span<std::byte> memory, const std::string& file);
  ~TapRing();
  TapRing(const TapRing&) = delete;
  TapRing& operator=(const TapRing&) = delete;

  // What the loop stated when it opened the tap.
  const std::string& controller() const { return facts_.controller; }
  std::filesystem::path model() const { return facts_.model; }  // empty: none
  double time_step() const { return facts_.time_step; }         // [s]
  double seconds() const { return facts_.seconds; }             // of a black box [s]
  int process() const { return facts_.process; }
  bool is_locked() const { return facts_.is_locked; }  // its memory can't be swapped out
  /// Of CLOCK_MONOTONIC and CLOCK_REALTIME at one moment [ns].
  std::uint64_t monotonic() const { return facts_.monotonic; }
  std::uint64_t realtime() const { return facts_.realtime; }

  /// Reads the series. They are complete when there is a tick.
  Result<TapDefinitions> definitions() const;
  bool has_ticks() const;

  enum class Got : std::uint8_t {
    nothing,  // no tick is there
    tick,
    overtaken,  // the loop has overwritten ticks before they were taken; the next one is the oldest that is left
    damaged     // something else has written into the ring; the next tick is the first that is written from now on
  };
  /// Takes the next tick. Of a reader that takes, the loop may overwrite it then.
  Got take(const TapDefinitions& definitions, TapTick& tick);
  /// Begins again with the oldest tick; beside a loop that overwrites ticks, a sixteenth of the ring later, so that it
  /// doesn't overtake the reader at once.
  void begin_with_oldest();
  /// Begins with the tick that is written next.
  void begin_with_next();
  /// From now on the loop doesn't count ticks as dropped.
  void take_all();
  /// The place behind the newest tick, and that behind the tick that take() has returned. Places only grow.
  std::uint64_t end() const;
  std::uint64_t place() const { return place_; }
  /// The ticks that take() has returned so far are in a file: a loop that restarts may remove the ring.
  void state_saved();

  /// False: the loop's process has ended, or closed the tap.
  bool has_loop() const;
  bool is_closed() const;  // by the loop
  /// Removes the file, unless the name is that of another ring by now.
  void remove_file() const;
  std::uint64_t dropped() const;
  std::uint64_t refused() const;  // calls that broke a rule

 private:
  /// What the loop stated when it opened the tap, copied: the memory may change at any time.
  struct Facts {
    std::string controller, model;
    double time_step = 0.0, seconds = 0.0;
    int process = 0;
    bool is_locked = false;
    std::uint64_t monotonic = 0, realtime = 0, words = 0;
  };
  TapRing(Facts facts, std::span<std::byte> memory, std::string file);

  Got take_next(const TapDefinitions& definitions, TapTick& tick);
  /// The loop counts ticks as dropped again, after a take_all() of an earlier reader.
  void count_dropped();

  Facts facts_;
  tap_ring_head* head_;
  std::span<std::byte> memory_;
  std::string file_;
  std::uint64_t* words_;
  std::uint64_t size_;  // of the ring [words]
  std::uint64_t place_ = 0;
  std::uint64_t begin_ = 0;  // ticks before this place are passed over
  bool takes_ = false, is_mapped_ = false;
  FileDescriptor descriptor_;
  std::vector<std::uint64_t> record_;
};

}  // namespace rehearse
