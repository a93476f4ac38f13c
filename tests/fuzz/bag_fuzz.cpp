// metadata.yaml of a rosbag2 folder: any text is refused with a place, or is a folder with files.
#include <rehearse/diagnostic.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "logs/bag/bag_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rehearse;
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto folder = bag::parse_folder(text, std::filesystem::temp_directory_path());
  if (!folder) {
    for (const Diagnostic& problem : folder.errors())
      REHEARSE_ASSERT(!problem.file.empty() && !problem.message.empty(), "a refusal says why");
    return 0;
  }
  REHEARSE_ASSERT(!folder->files.empty(), "a folder has files");
  return 0;
}
