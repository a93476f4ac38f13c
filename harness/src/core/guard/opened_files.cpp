#include "opened_files.h"

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <cnoid/ExecutablePath>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "base/hashing.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_files = 32, longest_path = 1024;

struct OpenedEntry {
  std::atomic<bool> whole{false};
  std::array<char, longest_path> path{};
};

struct Table {
  std::atomic<std::size_t> used{0};
  std::array<OpenedEntry, most_files> entries;
};

Table& table() {
  static constinit Table only;
  return only;
}

bool is_made_up(const std::string& path) {
  return path.starts_with("/proc/") || path.starts_with("/sys/") || path.starts_with("/dev/");
}

}  // namespace

void note_opened_file(const char* path) noexcept {
  if (!path || std::strlen(path) >= longest_path) return;
  Table& files = table();
  const std::size_t number = files.used.fetch_add(1);
  if (number >= most_files) return;
  OpenedEntry& entry = files.entries[number];
  std::strcpy(entry.path.data(), path);
  entry.whole.store(true);
}

std::vector<OpenedFile> take_files_opened() {
  Table& files = table();
  const std::size_t used = std::min(files.used.load(), most_files);
  if (used == 0) return {};
  std::vector<OpenedFile> opened;
  for (std::size_t i = 0; i < used; ++i) {
    OpenedEntry& entry = files.entries[i];
    if (!entry.whole.exchange(false)) continue;
    const std::string path = entry.path.data();
    std::error_code failed;
    const fs::file_status status = fs::status(path, failed);
    if (is_made_up(path) || (fs::exists(status) && !fs::is_regular_file(status))) continue;
    const bool is_there = fs::is_regular_file(status);
    opened.push_back(
        {fs::path(path).filename().string(), path,
         is_there ? fmt::format("{} bytes, {}", fs::file_size(path, failed), content_hash_of(path)) : missing_file});
  }
  files.used.store(0);
  return opened;
}

void copy_input(const OpenedFile& file, std::map<std::string, std::string>& copies) {
  std::error_code failed;
  const fs::path path = fs::weakly_canonical(file.path, failed);
  const fs::path below = path.lexically_relative(fs::weakly_canonical(cnoid::shareDirPath(), failed));
  const bool is_shared = !below.empty() && *below.begin() != "..";
  if ((!is_shared && path.extension() != ".seq") || file.content == missing_file) return;
  const std::uintmax_t size = fs::file_size(path, failed);
  if (failed || size > max_input_copy) return;
  std::ifstream stream(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  const std::string name = is_shared ? "share/" + below.string() : path.filename().string();
  copies.emplace(std::string(input_copies_prefix) + name, std::move(text));
}

}  // namespace rehearse
