#include "memory_check.h"

#include <fmt/format.h>
#include <valgrind/memcheck.h>

namespace rehearse {

void MemoryCheck::begin(const std::vector<OutputField>& fields) {
  looking_ = RUNNING_ON_VALGRIND != 0;
  if (looking_) fields_ = fields;
}

void MemoryCheck::look_at(std::int64_t tick, const std::vector<std::uint64_t>& row) {
  for (std::size_t i = 0; looking_ && i < row.size(); ++i) {
    if (VALGRIND_CHECK_MEM_IS_DEFINED(&row[i], sizeof row[i]) == 0) continue;
    undefined_ = fmt::format("{} of {} at tick {}", fields_[i].element, fields_[i].channel, tick);
    looking_ = false;
  }
}

}  // namespace rehearse
