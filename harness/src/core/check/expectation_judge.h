// ExpectationJudge: judges a run by the expectations of its scenario, in one pass over its pieces. Internal.
#pragma once

#include <rehearse/check.h>
#include <rehearse/messages.h>
#include <rehearse/trace.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/compare/tick_clock.h"
#include "core/expression/expression.h"
#include "formula_judge.h"

namespace rehearse {

/// The sample of a series, for the condition that its bounds are.
class SampleSource final : public ExpressionSource {
 public:
  double sample = 0.0, baseline = 0.0;

  Result<std::size_t> find_series(std::string_view) override { return std::size_t{0}; }
  Result<std::vector<std::size_t>> find_links(std::string_view) override { return std::vector<std::size_t>(); }
  double time_at(std::int64_t) const override { return 0.0; }
  double value(std::size_t, std::int64_t, CommandSide) override { return sample; }
  double value_at(std::size_t, double, std::int64_t) override { return baseline; }
  bool touching(const std::vector<std::size_t>&, const std::vector<std::size_t>&, std::int64_t) override {
    return false;
  }
};

/// Judges one series of a run by one expectation, at each of its samples. The run comes in pieces.
class SeriesJudge {
 public:
  SeriesJudge(const Expectation& expectation, const std::string& series);

  void take(const TraceChannel& channel, std::size_t column);
  enum class State { holds, violated, not_judged };
  /// Not judged: `problem` is the reason.
  State finish();
  /// Sets the ticks of `first` and `worst`, which are known only after all pieces.
  void set_ticks(const TickClock& clock);

  std::optional<ViolatingSample> first, worst;
  std::optional<Judgement> decisive;  // of the worst sample; with `sometime` of the best one
  std::string problem;

 private:
  bool is_asked_for(std::uint64_t time) const;
  void take_sample(const ViolatingSample& sample, const Judgement& judgement);

  const Expectation* expectation_;
  SampleSource source_;
  Expression condition_;
  std::optional<double> baseline_;
  std::uint64_t baseline_time_ = 0;
  std::optional<ViolatingSample> latest_;  // for a moment: the latest sample at it or before
  Judgement latest_judgement_;
  std::uint64_t latest_time_ = 0;
  bool any_ = false, any_right_ = false;
  bool any_number_ = false;  // not only NaN, which a message of joints has for a quantity that nobody enabled
  std::optional<ViolatingSample> nearest_;  // sample out of the bounds that is nearest to them
  double worst_margin_ = 0.0, nearest_margin_ = 0.0;
};

/// Judges one run, piece by piece, by all expectations.
class ExpectationJudge {
 public:
  /// The expectations must outlive this. `names`: a trace with all series of the run, for expressions; null: names that
  /// the first piece lacks are noticed at the end.
  explicit ExpectationJudge(const std::vector<Expectation>& expectations, const Trace* names = nullptr)
      : expectations_(expectations), formulas_(expectations, names) {
    cases_.resize(expectations.size());
  }

  /// True if the pieces must be in the order of time, because there are expressions.
  bool needs_order() const { return !formulas_.empty(); }

  void take(const Trace& piece);
  /// False if the run has no ticks, or no series for an expectation: then the results depend on all of its channels.
  bool found_all() const;
  /// `last`: the last piece, which also contains the data of the whole run.
  std::vector<ExpectationResult> finish(const Trace& last);
  /// After finish(): true if the first piece lacked names of expressions, so that the results are wrong.
  bool lacked_names() const { return formulas_.lacked_names(); }
  /// After finish(): true if an expression names a series that the pieces lack.
  bool any_mistake() const { return formulas_.any_mistake(); }

 private:
  struct JudgedSeries {
    SeriesJudge judge;
    std::string unit;
  };
  struct Case {
    std::map<std::string, JudgedSeries, std::less<>> series;  // those that match
    std::optional<msg::Event> event;                          // the first that matches
  };
  /// Summary of the series that match.
  struct Tally {
    std::int64_t found = 0, violating = 0;
    std::string unit;        // of all series; empty if there are several units
    std::string first_unit;  // of the series with the first violation
    std::string problem;     // of that series, if it has no violating sample
    std::string not_judged;  // the reason of a series that isn't judged
  };
  /// Why an expectation doesn't hold; empty: it does.
  struct Shortfall {
    std::string text;
    bool is_undecided = false;
  };

  void take_times(const Trace& piece);
  void take_series(const Expectation& expectation, const Trace& piece, Case& to) const;
  static void take_events(const Expectation& expectation, const Trace& piece, Case& to);
  void set_end(const Trace& last);

  std::string missing_time(const Expectation& expectation) const;
  static void tell(const Shortfall& shortfall, ExpectationResult& result);
  void judge_events(const Case& found, ExpectationResult& result) const;
  void judge_series(Case& found, const Trace& last, ExpectationResult& result) const;
  Shortfall shortfall_of(ExpectationResult& result, const Tally& tally, const Trace& last) const;
  static std::string violation_text(const ExpectationResult& result, const Tally& tally);
  static void take(const SeriesJudge& judge, const std::string& name, const std::string& unit,
                   ExpectationResult& result, Tally& tally);

  const std::vector<Expectation>& expectations_;
  FormulaRun formulas_;
  std::vector<Case> cases_;  // by index in expectations_
  TickClock clock_;
  std::uint64_t earliest_ = std::numeric_limits<std::uint64_t>::max(), latest_ = 0;  // of all messages [ns]
  std::uint64_t end_time_ = 0;                                                       // of the last tick [ns]
  std::uint64_t next_time_ = 0;  // at which one would be the next [ns]
  bool ended_early_ = false;     // the run failed, or was cut off
};

/// As judge_expectations() of a recording; with Damage::tolerate a damaged one is judged by its undamaged messages.
Result<std::vector<ExpectationResult>> judge_expectations(const std::vector<Expectation>& expectations,
                                                          const std::filesystem::path& recording, Trace::Damage damage,
                                                          std::size_t piece_size = Trace::usual_piece_size);

}  // namespace rehearse
