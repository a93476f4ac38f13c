// Corpus: the inputs of a search that reached something new, and what they reached. Internal.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "input_run.h"
#include "inputs.h"
#include "mutation.h"

namespace rehearse {

class Corpus {
 public:
  /// Keeps the inputs if their run reached something new; a run that isn't kept changes nothing here, so that the
  /// kept ones alone make the same corpus again. True: they were kept.
  bool take(const Inputs& inputs, std::int64_t run, const InputOutcome& outcome);

  bool empty() const { return entries_.empty(); }
  std::size_t size() const { return entries_.size(); }
  const Inputs& inputs(std::size_t entry) const { return entries_[entry].inputs; }
  std::int64_t run_of(std::size_t entry) const { return entries_[entry].run; }
  std::int64_t points() const;  // edges of code

  /// Inputs to change.
  struct Choice {
    std::size_t entry = 0;
    std::vector<SeenComparison> hints;  // comparisons in their run that may turn out otherwise
    bool is_aimed = false;              // at the only hint
    std::vector<std::size_t> columns;   // of an aimed choice: those that seem to matter
  };
  /// Prefers those that are the nearest to another outcome of a comparison, have the smallest margin or the largest
  /// command, or are new.
  Choice choose(Dice& dice) const;

 private:
  struct Entry {
    Inputs inputs;
    std::int64_t run = 0;
    std::vector<SeenComparison> comparisons;
  };
  struct Comparison {
    std::uint32_t seen = 0;  // in all runs
    double distance = 0.0;   // the smallest
    std::size_t entry = 0;   // that has it
    double a = 0.0, b = 0.0;
    bool varies = false;               // its operands aren't the same in all runs
    std::vector<std::size_t> columns;  // whose change made it nearer
  };
  struct Best {
    double value = 0.0;
    std::size_t entry = 0;
  };
  bool note_comparison(const SeenComparison& comparison, const Inputs& inputs, std::size_t entry);
  void note_columns(Comparison& comparison, const Inputs& inputs) const;
  /// True if only one of the orders of its operands was seen, and they depend on the inputs.
  static bool is_open(const Comparison& comparison) {
    const std::uint32_t orders = comparison.seen & 5;
    return comparison.varies && (orders == 1 || orders == 4);
  }

  std::vector<Entry> entries_;
  std::set<std::uint32_t> states_;
  std::map<std::uint32_t, Comparison> comparisons_;  // by place
  std::vector<Best> margins_, peaks_;
};

}  // namespace rehearse
