// RunSource: the numbers, contacts and messages of a run, tick by tick, for expressions. The run comes in pieces; only
// the last ticks are stored. Internal.
#pragma once

#include <rehearse/messages.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/expression/expression.h"

namespace rehearse {

class RunSource final : public ExpressionSource {
 public:
  /// Names and units of series are those of `names`, which must outlive the parsing of expressions.
  explicit RunSource(const Trace& names);

  /// The limits that an expression names, as its scenario has them.
  void set_limits(const std::map<std::string, Expectation::Limit>& limits) { limits_ = limits; }
  /// Stores what an expression needs of other ticks. Called before the first tick.
  void prepare(const Expression& expression);
  /// Of a series, by its id.
  const std::string& name_of(std::size_t series) const { return series_[series].name; }
  bool has_sample(std::size_t series) const { return series_[series].first_number.has_value(); }
  /// True if its first messages have NaN, and a later one a number.
  bool begins_with_nan(std::size_t series) const;
  /// Names of the series that were found, in the order of the first request.
  const std::vector<std::string>& found() const { return found_; }

  using OnTick = std::function<void(std::int64_t index, std::uint64_t time)>;
  /// Adds a piece. Pieces are in the order of time: a message of a later piece isn't earlier than one of this piece.
  /// Calls `on_tick` for each tick that is complete.
  void take(const Trace& piece, const OnTick& on_tick);
  /// Calls it for the remaining ticks. Returns the time of the last one [ns]; nullopt: there was none.
  std::optional<std::uint64_t> finish(const OnTick& on_tick);

  // ExpressionSource. A tick is an index in the order of time; only the last ticks have values.
  Result<std::size_t> find_series(std::string_view name) override;
  Result<std::vector<std::size_t>> find_links(std::string_view name) override;
  std::string unit_of_series(std::size_t series) override { return series_[series].unit; }
  Result<std::size_t> find_joint_series(std::string_view joint, std::string_view quantity, bool of_command) override;
  Result<JointLimit> find_limit(std::string_view joint, std::string_view limit) override;
  std::int64_t number_of(std::int64_t tick) const override { return slot(tick).number; }
  double time_at(std::int64_t tick) const override { return slot(tick).seconds; }
  double value(std::size_t series, std::int64_t tick, CommandSide) override {
    return values_[series * kept + static_cast<std::size_t>(tick) % kept];
  }
  Sampled sampled(std::size_t series, std::int64_t tick, CommandSide) const override;
  Sampled sampled_at(std::size_t series, double time, std::int64_t tick) const override;
  bool touching(const std::vector<std::size_t>& links, const std::vector<std::size_t>& others,
                std::int64_t tick) override;
  bool said(std::string_view pattern, std::int64_t tick) override;
  bool happened(std::string_view pattern, std::int64_t tick) override;
  double value_at(std::size_t series, double time, std::int64_t tick) override;

 private:
  static constexpr std::size_t kept = 8;  // ticks; more than Expression::most_shifts
  static_assert(kept > static_cast<std::size_t>(Expression::most_shifts));

  struct Sample {
    std::uint64_t time = 0;
    double value = 0.0;
  };
  struct Series {
    std::string name, unit;
    std::vector<Sample> waiting;  // samples that no tick has reached, from `next` on
    std::size_t next = 0;
    double latest = 0.0;
    std::optional<std::int64_t> first_message, first_number;  // ticks
  };
  /// The latest value of a series up to a time.
  struct HeldValue {
    std::size_t series = 0;
    double time = 0.0;            // [s]
    std::optional<double> value;  // none: there was no message up to then
  };
  struct Tick {
    std::int64_t number = 0;
    double seconds = 0.0;
    std::vector<msg::Event> events;
    std::set<std::pair<std::string, std::string>> touching;
  };
  struct WaitingTick {
    std::uint64_t time = 0;
    std::int64_t number = 0;
  };

  std::size_t use(const std::string& name);
  /// Null: the tick is earlier than the time.
  const HeldValue* held_at(std::size_t series, double time, std::int64_t tick) const;
  const Tick& slot(std::int64_t tick) const { return ticks_[static_cast<std::size_t>(tick) % kept]; }
  void take_samples(const Trace& piece);
  void take_ticks(const Trace& piece);
  void pass(const WaitingTick& tick, const OnTick& on_tick);
  void pass_samples(Series& series, std::size_t index, std::uint64_t time);
  void pass_contacts(std::uint64_t time);

  const Trace* names_;
  std::vector<std::string> all_names_;
  std::map<std::string, Expectation::Limit> limits_;
  std::vector<Series> series_;
  std::vector<std::string> found_;
  std::vector<std::string> links_;  // names as expressions have them
  std::vector<HeldValue> held_;
  std::vector<double> values_;  // of each series, of the last ticks
  std::array<Tick, kept> ticks_;
  std::deque<WaitingTick> waiting_ticks_;
  std::deque<msg::Event> waiting_events_;
  std::deque<msg::ContactChange> waiting_changes_;
  std::set<std::pair<std::string, std::string>> touching_;
  std::int64_t passed_ = 0;  // ticks
  std::optional<std::uint64_t> last_time_;
};

}  // namespace rehearse
