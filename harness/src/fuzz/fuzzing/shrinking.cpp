#include "shrinking.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace rehearse {
namespace {

constexpr int most_runs = 3000, most_processes = 200;  // a run that ends its process takes a new one
constexpr std::size_t at_once = 16;  // candidates that are tried together; the first that fails in the same way counts

class Shrinker {
 public:
  Shrinker(InputWorkers& workers, const FuzzSetup& setup, ShrunkInputs best)
      : workers_(workers),
        setup_(setup),
        best_(std::move(best)),
        kind_(best_.outcome),
        budget_(ends_process(kind_.end) ? most_processes : most_runs) {}

  Result<ShrunkInputs> go();

 private:
  Result<bool> try_all(std::vector<Inputs> candidates);
  Result<void> cut_end();
  Result<void> cut_ticks();
  Result<void> leave_columns_alone();
  Result<void> hold_columns();
  Result<void> drop_changes();
  Result<void> round_numbers();
  Inputs with_change_dropped(std::size_t column, int from, int until) const;
  const std::vector<InputColumn>& columns() const { return setup_.columns; }

  InputWorkers& workers_;
  const FuzzSetup& setup_;
  ShrunkInputs best_;
  const InputOutcome kind_;
  const int budget_;
};

/// Takes the first of the candidates that fails in the same way. False: none does.
Result<bool> Shrinker::try_all(std::vector<Inputs> candidates) {
  std::erase_if(candidates, [this](const Inputs& one) { return one.ticks() == 0 || one == best_.inputs; });
  for (std::size_t first = 0; first < candidates.size() && best_.runs < budget_; first += at_once) {
    const std::vector<Inputs> some(
        candidates.begin() + static_cast<std::ptrdiff_t>(first),
        candidates.begin() + static_cast<std::ptrdiff_t>(std::min(first + at_once, candidates.size())));
    const auto outcomes = REHEARSE_TRY(workers_.run(some));
    best_.runs += static_cast<int>(some.size());
    for (std::size_t i = 0; i < some.size(); ++i) {
      if (!outcomes[i].is_like(kind_)) continue;
      best_.inputs = some[i];
      best_.outcome = outcomes[i];
      return true;
    }
  }
  return false;
}

/// No tick after the one at which it fails; a violation may be seen a tick after the command.
Result<void> Shrinker::cut_end() {
  std::vector<Inputs> candidates;
  for (const std::int64_t ticks : {best_.outcome.tick, best_.outcome.tick + 1, best_.outcome.tick + 2}) {
    if (ticks < 1 || ticks >= best_.inputs.ticks()) continue;
    Inputs shorter = best_.inputs;
    shorter.values.resize(static_cast<std::size_t>(ticks) * shorter.columns);
    candidates.push_back(std::move(shorter));
  }
  REHEARSE_TRY(try_all(std::move(candidates)));
  return {};
}

/// Leaves out ticks: halves first, single ones last.
Result<void> Shrinker::cut_ticks() {
  for (int size = best_.inputs.ticks() / 2; size >= 1; size /= 2) {
    for (bool found = true; found;) {
      std::vector<Inputs> candidates;
      for (int from = 0; from + size <= best_.inputs.ticks(); from += size) {
        Inputs shorter = best_.inputs;
        const auto width = static_cast<std::ptrdiff_t>(shorter.columns);
        shorter.values.erase(shorter.values.begin() + from * width, shorter.values.begin() + (from + size) * width);
        candidates.push_back(std::move(shorter));
      }
      found = REHEARSE_TRY(try_all(std::move(candidates)));
    }
  }
  return {};
}

Result<void> Shrinker::leave_columns_alone() {
  for (bool found = true; found;) {
    std::vector<Inputs> candidates;
    for (std::size_t column = 0; column < columns().size(); ++column) {
      Inputs fewer = best_.inputs;
      for (int tick = 0; tick < fewer.ticks(); ++tick) fewer.at(tick, column) = columns()[column].start;
      candidates.push_back(std::move(fewer));
    }
    found = REHEARSE_TRY(try_all(std::move(candidates)));
  }
  return {};
}

/// A value that stays, in the place of one that changes.
Result<void> Shrinker::hold_columns() {
  for (std::size_t column = 0; column < columns().size(); ++column) {
    std::vector<Inputs> candidates;
    for (const int from : {0, best_.inputs.ticks() / 2, best_.inputs.ticks() - 1}) {
      Inputs held = best_.inputs;
      for (int tick = 0; tick < held.ticks(); ++tick) held.at(tick, column) = best_.inputs.at(from, column);
      candidates.push_back(std::move(held));
    }
    REHEARSE_TRY(try_all(std::move(candidates)));
  }
  return {};
}

/// The values of these ticks are that of the tick before, or the start.
Inputs Shrinker::with_change_dropped(std::size_t column, int from, int until) const {
  Inputs fewer = best_.inputs;
  const double before = from == 0 ? columns()[column].start : fewer.at(from - 1, column);
  for (int tick = from; tick < until; ++tick) fewer.at(tick, column) = before;
  return fewer;
}

Result<void> Shrinker::drop_changes() {
  for (std::size_t column = 0; column < columns().size(); ++column) {
    for (int size = std::max(1, best_.inputs.ticks() / 2); size >= 1; size /= 2) {
      for (bool found = true; found;) {
        std::vector<Inputs> candidates;
        for (int from = 0; from < best_.inputs.ticks(); from += size)
          candidates.push_back(with_change_dropped(column, from, std::min(best_.inputs.ticks(), from + size)));
        found = REHEARSE_TRY(try_all(std::move(candidates)));
      }
    }
  }
  return {};
}

/// Fewer digits, value by value; equal ones together.
Result<void> Shrinker::round_numbers() {
  for (std::size_t column = 0; column < columns().size(); ++column) {
    std::vector<double> values;
    for (int tick = 0; tick < best_.inputs.ticks(); ++tick) values.push_back(best_.inputs.at(tick, column));
    std::ranges::sort(values);
    values.erase(std::unique(values.begin(), values.end()), values.end());
    for (const double value : values) {
      if (value == columns()[column].start || !std::isfinite(value) || value == 0.0) continue;
      std::vector<Inputs> candidates;
      const int power = std::ilogb(std::abs(value)) * 301 / 1000;  // about its decimal exponent
      for (int digits = -power - 2; digits <= -power + 8; ++digits) {
        const double unit = std::pow(10.0, digits);
        for (const double whole : {std::trunc(value * unit), std::round(value * unit),
                                   std::trunc(value * unit) + std::copysign(1.0, value)}) {
          const double rounded = columns()[column].clamped(whole / unit);
          if (rounded == value) continue;
          Inputs rounder = best_.inputs;
          for (int tick = 0; tick < rounder.ticks(); ++tick)
            if (rounder.at(tick, column) == value) rounder.at(tick, column) = rounded;
          candidates.push_back(std::move(rounder));
        }
      }
      REHEARSE_TRY(try_all(std::move(candidates)));
    }
  }
  return {};
}

Result<ShrunkInputs> Shrinker::go() {
  constexpr int most_rounds = 4;
  for (int round = 0; round < most_rounds; ++round) {
    const Inputs before = best_.inputs;
    REHEARSE_TRY(cut_end());
    REHEARSE_TRY(leave_columns_alone());
    REHEARSE_TRY(cut_ticks());
    REHEARSE_TRY(hold_columns());
    REHEARSE_TRY(drop_changes());
    REHEARSE_TRY(round_numbers());
    if (best_.inputs == before || best_.runs >= budget_) break;
  }
  return std::move(best_);
}

}  // namespace

Result<ShrunkInputs> shrink_inputs(InputWorkers& workers, const FuzzSetup& setup, const Inputs& inputs,
                                   const InputOutcome& outcome) {
  return Shrinker(workers, setup, {inputs, outcome, 0}).go();
}

}  // namespace rehearse
