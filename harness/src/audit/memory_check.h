// MemoryCheck: finds the first output of a controller that was never set, in a process that runs under valgrind. In any
// other process it has no effect.
#pragma once

#include <rehearse/replay.h>

#include <cstdint>
#include <string>
#include <vector>

namespace rehearse {

class MemoryCheck {
 public:
  void begin(const std::vector<OutputField>& fields);
  void look_at(std::int64_t tick, const std::vector<std::uint64_t>& row);
  /// "LLEG_KNEE/u of /SR1/Stand/output/joints at tick 3"; empty: there is none.
  const std::string& undefined() const { return undefined_; }

 private:
  bool looking_ = false;
  std::vector<OutputField> fields_;
  std::string undefined_;
};

}  // namespace rehearse
