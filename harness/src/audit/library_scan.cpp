#include "audit/library_scan.h"

namespace rehearse {

Result<LibraryScan> scan_library(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return error("can't read " + file.string());
  return LibraryScan{};
}

}  // namespace rehearse
