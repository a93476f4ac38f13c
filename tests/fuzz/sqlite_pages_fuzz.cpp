// The rows of a damaged database: of any bytes, each row is in the file, and all of them together aren't longer than it.
#include <rehearse/diagnostic.h>

#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>

#include "logs/bag/sqlite_pages.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rehearse;
  std::istringstream file(std::string(reinterpret_cast<const char*>(data), size));
  bag::TablePages table(file, {4, 1, 2, 3, [](std::int64_t topic) { return topic == 1; }});
  std::int64_t before = INT64_MIN;
  std::size_t bytes = 0;
  for (const bag::PageRow& row : table.rows()) {
    REHEARSE_ASSERT(row.id >= before && row.topic == 1 && row.time >= 0, "rows are messages in the order of their ids");
    before = row.id;
    if (const auto payload = table.data_of(row)) bytes += payload->size() > 512 ? payload->size() - 512 : 0;
  }
  REHEARSE_ASSERT(bytes <= size, "no page is two rows'");
  return 0;
}
