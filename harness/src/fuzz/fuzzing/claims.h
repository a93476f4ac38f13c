// Claims: the expectations of a fuzz test, judged on a run in memory. Internal.
#pragma once

#include <rehearse/scenario.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/expression/expression.h"
#include "core/expression/formula.h"

namespace rehearse {

/// A series of a run.
struct NamedSeries {
  std::string name, unit;
};

/// The numbers of a run, a row for each tick.
class RunTable final : public ExpressionSource {
 public:
  RunTable(std::vector<NamedSeries> series, double time_step);

  const std::vector<NamedSeries>& series() const { return series_; }
  void clear() { rows_.clear(); }
  /// Begins a tick; its values are those of the tick before, NaN in the first one.
  void add_tick();
  void set(std::size_t series, double value) { rows_[rows_.size() - series_.size() + series] = value; }
  std::int64_t ticks() const {
    return static_cast<std::int64_t>(rows_.size() / std::max<std::size_t>(1, series_.size()));
  }
  void set_limits(const std::map<std::string, Expectation::Limit>& limits) { limits_ = limits; }

  Result<std::size_t> find_series(std::string_view name) override;
  Result<std::vector<std::size_t>> find_links(std::string_view name) override;
  std::string unit_of_series(std::size_t series) override { return series_[series].unit; }
  Result<std::size_t> find_joint_series(std::string_view joint, std::string_view quantity, bool of_command) override;
  Result<JointLimit> find_limit(std::string_view joint, std::string_view limit) override;
  std::int64_t last_tick() const override { return ticks() - 1; }
  double time_at(std::int64_t tick) const override;
  Sampled sampled(std::size_t series, std::int64_t tick, CommandSide) const override;
  Sampled sampled_at(std::size_t series, double time, std::int64_t tick) const override;
  double value(std::size_t series, std::int64_t tick, CommandSide) override { return number(series, tick); }
  double value_at(std::size_t series, double time, std::int64_t tick) override;
  bool touching(const std::vector<std::size_t>&, const std::vector<std::size_t>&, std::int64_t) override {
    return false;
  }

 private:
  double number(std::size_t series, std::int64_t tick) const {
    return rows_[static_cast<std::size_t>(tick) * series_.size() + series];
  }
  std::optional<std::int64_t> tick_of(double time, std::int64_t tick) const;

  std::vector<NamedSeries> series_;
  std::vector<std::string> names_;
  std::map<std::string, Expectation::Limit> limits_;
  double time_step_;
  std::vector<double> rows_;
};

/// What a run says about an expectation.
struct ClaimResult {
  bool holds = true;
  std::int64_t tick = 0;         // the first that violates it
  std::string sentence;          // of a violation
  std::optional<double> margin;  // none: no numbers were compared
};

class Claims {
 public:
  /// Parses the expectations with the names of the table, which must outlive this.
  static Result<Claims> parse(const std::vector<Expectation>& expectations, RunTable& table);

  std::size_t count() const { return claims_.size(); }
  const std::string& text_of(std::size_t claim) const { return claims_[claim]->text; }
  /// Judges the run in the table.
  ClaimResult judge(std::size_t claim) const;

 private:
  struct Claim {
    std::string text;
    Formula formula;
  };
  RunTable* table_ = nullptr;
  std::vector<std::unique_ptr<Claim>> claims_;
};

}  // namespace rehearse
