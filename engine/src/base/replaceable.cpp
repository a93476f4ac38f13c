#include "replaceable.h"

#include <fmt/format.h>

#include <fstream>

namespace rehearse {

Result<void> check_replaceable(const std::filesystem::path& file, std::string_view magic, std::string_view kind) {
  if (file == "-")
    return error("'-' is no file: nothing is written to standard output", "name a file; './-' is a file of that name");
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    return error(fmt::format("can't write {}: it is a directory", file.string()));
  if (!std::filesystem::is_regular_file(file, ignored) || std::filesystem::file_size(file, ignored) == 0) return {};
  std::string begin(magic.size(), '\0');
  std::ifstream(file, std::ios::binary).read(begin.data(), static_cast<std::streamsize>(begin.size()));
  if (begin == magic) return {};
  return error(fmt::format("won't replace {}: it exists and is no {}", file.string(), kind),
               "name another file, or remove it first");
}

}  // namespace rehearse
