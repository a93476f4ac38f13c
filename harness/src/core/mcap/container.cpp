#include "container.h"

#include <atomic>
#include <cstring>
#include <string_view>
#include <system_error>

#include "contents.h"

namespace rehearse::mcap {
namespace {

bool begins_with(Bytes bytes, std::string_view text) {
  return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

std::atomic<const ContainerReader*> reader_of_others{nullptr};

}  // namespace

Container container_of(Bytes start) {
  if (begins_with_magic(start)) return Container::mcap;
  if (begins_with(start, std::string_view("SQLite format 3\0", 16))) return Container::sqlite;
  if (begins_with(start, "\x28\xb5\x2f\xfd")) return Container::zstd;
  if (begins_with(start, "#ROSBAG V")) return Container::ros1_bag;
  if (begins_with(start, "version https://git-lfs")) return Container::git_lfs_pointer;
  return Container::unknown;
}

std::filesystem::path folder_of(const std::filesystem::path& log) {
  std::error_code ignored;
  if (std::filesystem::is_directory(log, ignored)) return log;
  if (log.filename() != "metadata.yaml") return {};
  return log.has_parent_path() ? log.parent_path() : std::filesystem::path(".");
}

void set_container_reader(const ContainerReader& reader) { reader_of_others = &reader; }
const ContainerReader* container_reader() { return reader_of_others; }

}  // namespace rehearse::mcap
