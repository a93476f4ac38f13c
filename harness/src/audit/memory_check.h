// MemoryCheck: in a process that valgrind runs, the first number that a controller gave without ever having set it.
// In any other process it does nothing.
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
