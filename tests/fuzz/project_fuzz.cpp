// For any bytes, the importer of projects returns a scenario or errors, and never crashes or hangs.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "choreonoid/import/import.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rehearse::ImportOptions options;
  options.folder = FIXTURES_DIR;
  const auto result =
      rehearse::import_project_text(std::string(data, data + size), FIXTURES_DIR "/projects/fuzz.cnoid", options);
  if (!result) return result.errors().empty() ? (std::abort(), 1) : 0;
  if (!result->scenario.starts_with("#") || result->items.empty()) std::abort();
  return 0;
}
