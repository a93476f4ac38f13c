// Mutation: new inputs at random, and changed ones. Internal.
#pragma once

#include <cstdint>
#include <vector>

#include "base/chance.h"
#include "base/hashing.h"
#include "input_run.h"
#include "inputs.h"

namespace rehearse {

/// The random numbers of one run of a search: a function of its seed and of the number of the run.
class Dice {
 public:
  Dice(std::uint64_t seed, std::int64_t run) : chance_(hash_bytes(&seed, sizeof seed), run) {}

  double uniform() { return chance_.uniform(place_++); }  // between 0 and 1
  double between(double low, double high) { return low + (high - low) * uniform(); }
  /// 0 to count - 1; the count is at least 1.
  std::size_t below(std::size_t count) {
    const auto drawn = static_cast<std::size_t>(uniform() * static_cast<double>(count));
    return drawn < count ? drawn : count - 1;
  }
  bool happens(double probability) { return uniform() < probability; }

 private:
  Chance chance_;
  std::uint64_t place_ = 0;
};

class Mutator {
 public:
  Mutator(const std::vector<InputColumn>& columns, int ticks) : columns_(columns), ticks_(ticks) {}

  /// New inputs: each column is constant, steps, a spline, noise, or constant with single ticks.
  Inputs fresh(Dice& dice) const;
  /// One to four changes of the inputs. `other`: inputs of which parts may be taken. `hints`: comparisons of the code
  /// in the run of the inputs. `is_aimed`: the first change follows a hint, most often in one of `columns`.
  Inputs mutated(const Inputs& inputs, const Inputs& other, const std::vector<SeenComparison>& hints, bool is_aimed,
                 const std::vector<std::size_t>& columns, Dice& dice) const;

 private:
  struct Span {
    int from = 0, until = 0;  // ticks; `until` isn't in it
  };
  Span span(Dice& dice) const;
  double value(const InputColumn& column, Dice& dice) const;
  void fill(Inputs& inputs, std::size_t column, const Span& span, Dice& dice) const;
  void fill_spline(Inputs& inputs, std::size_t column, const Span& span, Dice& dice) const;
  void nudge(Inputs& inputs, std::size_t column, const Span& span, Dice& dice) const;
  void swap_alike(Inputs& inputs, std::size_t column, const Span& span, Dice& dice) const;
  void splice(Inputs& inputs, const Inputs& other, std::size_t column, const Span& span, Dice& dice) const;
  void move(Inputs& inputs, std::size_t column, const Span& span, Dice& dice) const;
  bool follow(Inputs& inputs, const std::vector<SeenComparison>& hints, const std::vector<std::size_t>& columns,
              Dice& dice) const;
  void approach(Inputs& inputs, const SeenComparison& hint, const std::vector<std::size_t>& columns, Dice& dice) const;
  void change(Inputs& inputs, const Inputs& other, const std::vector<SeenComparison>& hints, Dice& dice) const;

  const std::vector<InputColumn>& columns_;
  int ticks_;
};

}  // namespace rehearse
