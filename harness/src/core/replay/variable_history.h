// VariableHistory: the variables of the controllers in a replay beside the recorded ones, to explain their differences.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "core/compare/series_relations.h"

namespace rehearse {

class VariableHistory {
 public:
  /// So many numbers are kept, of each run [numbers].
  static constexpr std::size_t most = 500'000;

  /// Takes a variable that both runs set in a tick. Ticks ascend.
  void add(const std::string& topic, std::int64_t tick, double recorded, double present);
  /// One sentence about the variables that differ; empty if nothing is known. `controllers`: their number.
  std::string explanation(int controllers) const;

 private:
  std::map<std::string, PairedSeries> series_;  // by topic
  std::int64_t last_tick_ = -1;
  std::size_t count_ = 0;
  bool is_whole_ = true;  // nothing was left out
};

}  // namespace rehearse
