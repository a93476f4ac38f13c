// SteppedTrace: shows a recording at any of its ticks, with the present commands of its controllers for its inputs.
//
// Recorded data is read directly from the file, by its index. The present outputs of the controllers are computed once,
// when the trace is opened; only differences are stored, in a file. So all ticks are read equally fast, in any order.
// The memory doesn't grow with the length of the recording, except for its changes of contact with 16 bytes each.
//
// Replaying links neither physics nor renderer. If the controllers can't be replayed, or only up to some tick, the
// recorded data is still available; remarks() reports this.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/diagnostic.h>
#include <rehearse/run_options.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/expression/expression.h"

namespace rehearse {

struct SteppingOptions : HostOptions {
  /// The controllers are replayed up to the end of this tick, which must exist; none: to the end.
  std::optional<std::int64_t> last_tick = std::nullopt;
  /// The last tick as a time, which may be after the end [s]; the tick that is current at that time.
  std::optional<double> last_time = std::nullopt;
  bool replay = true;
  /// Called about every hundredth of the replay with the number of ticks done and of all; null: not.
  std::function<void(std::int64_t done, std::int64_t all)> progress = nullptr;
};

/// A number at a tick.
struct ViewValue {
  std::string element;  // within the channel: RLEG_KNEE/q
  std::string series;
  std::string unit;                     // may be empty
  double value = 0.0;                   // as recorded
  std::optional<double> before = {};    // value in the tick before; none: there is no tick before
  std::optional<double> replayed = {};  // present value of the replay, if it differs
  std::uint64_t ulps = 0;               // between both

  bool changed() const { return before && !identical(value, *before); }
};

/// The numbers of one channel at a tick.
struct ViewChannel {
  enum class Kind {
    input,   // inputs of a controller
    output,  // commands of a controller
    state,   // state of a body's joints and links
    sensor,  // measurements of a device
    other,
  };
  std::string topic;
  std::string owner;  // the controller, as SR1/SR1Minimum; else the body; may be empty
  std::string part;   // of the topic, after the owner: "joints", "WAIST/pose"
  Kind kind = Kind::other;
  bool is_joints = false;  // elements are JOINT/q, JOINT/dq, JOINT/u
  std::vector<ViewValue> values;
};

struct ViewMessage {
  std::string severity;  // note, warning, error
  std::string source;    // as SR1/SR1Minimum
  std::string text;
  enum class Where { both, recorded, replayed } where = Where::recorded;
};

struct ViewContact {
  std::string link, other;  // as SR1/RLEG_ANKLE_R
  bool touches = true;      // false: the contact ended in this tick
  bool began = false;       // in this tick
};

/// A picture that arrived in this tick.
struct ViewPicture {
  std::string topic;
  std::uint64_t bytes = 0;
};

struct TickView {
  std::int64_t tick = 0;
  double time = 0.0;         // [s]
  bool is_replayed = false;  // the replay reached this tick
  std::vector<ViewChannel> channels;
  std::vector<ViewMessage> messages;
  std::vector<ViewContact> contacts;
  std::vector<ViewPicture> pictures;
  std::vector<std::string> threads;  // of controllers, after the tick: "walk.cpp:88: 'planner' waits for a condition"
  std::vector<Divergence> differences;  // differences of the controllers from the recording
};

enum class Direction { forwards, backwards };

class SteppedTrace : public ExpressionSource {
 public:
  /// Fails if the file is no recording of Rehearse, or has no tick.
  static Result<std::unique_ptr<SteppedTrace>> open(const std::filesystem::path& file,
                                                    const SteppingOptions& options = {});
  ~SteppedTrace() override;
  SteppedTrace(const SteppedTrace&) = delete;
  SteppedTrace& operator=(const SteppedTrace&) = delete;

  const std::string& file() const;
  /// Remarks for the user: damage, controllers that aren't the recorded ones, the end of the replay.
  const Diagnostics& remarks() const;
  std::int64_t first_tick() const override;
  std::int64_t last_tick() const override;
  /// The last tick to which the controllers were replayed; none: they weren't.
  std::optional<std::int64_t> last_replayed() const;
  /// True if the controllers differ from the recording in some tick.
  bool differs() const;
  /// The first tick in which they differ; none: they don't.
  std::optional<std::int64_t> first_difference() const;
  /// The failure of a controller that ended the replay.
  const std::optional<Diagnostic>& failure() const;
  double time_at(std::int64_t tick) const override;
  /// The current tick at that time: the last tick that isn't later.
  std::int64_t tick_at(double time) const;

  TickView view(std::int64_t tick);
  std::vector<ViewMessage> messages(std::int64_t tick);
  std::vector<ViewContact> contacts(std::int64_t tick);
  /// TickView::threads.
  std::vector<std::string> threads(std::int64_t tick);
  std::vector<Divergence> differences(std::int64_t tick);
  /// The nearest tick after (or before) that tick in which the controllers begin to differ, a message is written, or a
  /// contact begins or ends.
  std::optional<std::int64_t> happening(std::int64_t tick, Direction direction);

  /// All series that are known, sorted.
  const std::vector<std::string>& series_names();
  const std::string& series_name(std::size_t series) const;
  std::string series_unit(std::size_t series) const;
  /// The series that match the pattern, or a name or ending as an expression has it. Fails if there is none.
  Result<std::vector<std::size_t>> find_all_series(std::string_view pattern);

  /// The cameras' topics.
  std::vector<std::string> picture_topics() const;
  struct Picture {
    std::int64_t tick = 0;  // in which it arrived
    std::string topic;
    std::string extension;            // "png"; empty: the camera was off
    std::vector<std::uint8_t> bytes;  // of the file
  };
  /// The latest picture at or before that tick of the camera whose topic ends so (empty: the only one).
  Result<Picture> picture(std::string_view camera, std::int64_t tick);

  // ExpressionSource
  Result<std::size_t> find_series(std::string_view name) override;
  bool is_replayed(std::size_t series) const override;
  bool has_replay() const override { return true; }
  Result<std::vector<std::size_t>> find_links(std::string_view name) override;
  double value(std::size_t series, std::int64_t tick, CommandSide side) override;
  bool touching(const std::vector<std::size_t>& links, const std::vector<std::size_t>& others,
                std::int64_t tick) override;
  bool differs_at(std::int64_t tick) override;
  bool said(std::string_view pattern, std::int64_t tick) override;
  bool happened(std::string_view pattern, std::int64_t tick) override;
  std::string unit_of_series(std::size_t series) override { return series_unit(series); }
  Result<std::size_t> find_joint_series(std::string_view joint, std::string_view quantity, bool of_command) override;
  Result<JointLimit> find_limit(std::string_view joint, std::string_view limit) override;
  double value_at(std::size_t series, double time, std::int64_t tick) override;

 private:
  class Impl;
  explicit SteppedTrace(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// A span of consecutive ticks.
struct TickSpanFound {
  std::int64_t first = 0, last = 0;  // both included
};

/// Calls `found` with each span of ticks, from `first` to `last`, in which the boolean expression is true. False from
/// it, or true from `interrupted` (null: never), ends the search. Returns false if it was interrupted.
bool find_spans(const Expression& expression, SteppedTrace& trace, std::int64_t first, std::int64_t last,
                const std::function<bool(const TickSpanFound&)>& found,
                const std::function<bool()>& interrupted = nullptr);

/// The nearest tick after `from` (or before it, backwards) in which the expression is true, and false in the tick
/// passed before. None: there is no such tick, or the search was interrupted.
std::optional<std::int64_t> find_tick(const Expression& expression, SteppedTrace& trace, std::int64_t from,
                                      Direction direction, const std::function<bool()>& interrupted = nullptr);

}  // namespace rehearse
