#include "test_history.h"

#include <cstdlib>
#include <optional>

#include "viewing/history/history.h"

namespace rehearse::internal {
namespace {

std::string stated(const char* variable) {
  const char* value = std::getenv(variable);
  return value ? value : "";
}

/// Of all tests of this process: git is asked once.
const Result<HistoryStamp>& stamp_of_tests(const std::string& file) {
  static const Result<HistoryStamp> stamp =
      stamp_of(stated("REHEARSE_HISTORY_COMMIT"), stated("REHEARSE_HISTORY_DATE"), ".", file);
  return stamp;
}

Result<void> append(const std::string& file, const std::string& test, const CheckReport& report) {
  const Result<HistoryStamp>& stamp = stamp_of_tests(file);
  if (!stamp) return stamp.errors();
  return append_to_history(file, {text_of(line_of(*stamp, test, report))});
}

}  // namespace

void keep_in_history(const std::string& test, const CheckReport& report, TestVerdict& verdict) {
  const std::string file = stated("REHEARSE_HISTORY");
  if (file.empty()) return;
  if (const auto appended = append(file, test, report); !appended) {
    verdict.message += (verdict.message.empty() ? "" : "\n") + to_string(appended.errors());
    verdict.passed = false;
  }
}

}  // namespace rehearse::internal
