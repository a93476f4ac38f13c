// TurnOrder: another legal order of threads that take turns.
//
// Where several threads are ready, the scheduler asks which comes first: where a thread waits, yields or ends, before
// it takes a lock, and after it has woken another one. Without an order that is the thread that was woken first, or the
// one that runs. An order is a list of exchanges, each at one of these places, or is drawn.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace rehearse {

/// A place where several threads are ready: the number of the call into a controller, and of the place since its begin.
struct OrderPlace {
  std::int64_t call = 0, number = 0;
  friend auto operator<=>(const OrderPlace&, const OrderPlace&) = default;
};

/// The thread that was woken `behind` places after the first one comes first.
struct Exchange {
  OrderPlace place;
  int behind = 0;
};

class TurnOrder {
 public:
  /// These exchanges, and no others.
  explicit TurnOrder(const std::vector<Exchange>& exchanges);
  /// The thread with the highest of random priorities comes first. At some places, counted from 0 over the run, it gets
  /// the lowest one. An order that needs d - 1 such changes is drawn with a probability of at least 1 / (t n^(d - 1)),
  /// for t threads and n places (S. Burckhardt et al., A Randomized Scheduler with Probabilistic Guarantees of Finding
  /// Bugs, ASPLOS 2010).
  TurnOrder(std::uint64_t seed, std::vector<std::int64_t> changes);

  bool is_drawn() const { return is_drawn_; }
  /// The index of the thread that comes first. `ready`: the numbers of the threads, at least two.
  std::size_t choose(OrderPlace place, std::span<const int> ready);
  /// The number of places so far.
  std::int64_t places() const { return places_; }

 private:
  double priority_of(int thread) const;

  bool is_drawn_ = false;
  std::map<OrderPlace, int> exchanges_;
  std::uint64_t seed_ = 0;
  std::vector<std::int64_t> changes_;
  std::map<int, double> lowered_;  // priorities of threads that got the lowest one
  std::int64_t places_ = 0;
};

}  // namespace rehearse
