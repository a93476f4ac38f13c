// metadata.yaml of a rosbag2 folder: any text is refused with a place, or is a folder with files.
#include <rehearse/diagnostic.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include "logs/bag/bag_folder.h"
#include "scratch.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rehearse;
  const Scratch scratch("_bag");
  std::filesystem::create_directory(scratch.path);
  std::ofstream(scratch.path / "metadata.yaml", std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  const auto folder = bag::read_folder(scratch.path);
  if (!folder) {
    for (const Diagnostic& problem : folder.errors())
      REHEARSE_ASSERT(!problem.file.empty() && !problem.message.empty(), "a refusal says why");
    return 0;
  }
  REHEARSE_ASSERT(!folder->files.empty(), "a folder has files");
  return 0;
}
