#include "export_files.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "base/write_hint.h"

namespace rehearse {
namespace {

Diagnostic cannot_write(const std::filesystem::path& file) {
  return error(fmt::format("can't write {}: {}", file.string(), std::strerror(errno)),
               write_hint(file, "name another file with -o"));
}

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
}

}  // namespace

std::string TopicNames::name_for(std::string_view topic) {
  constexpr std::size_t longest = 150;  // file systems allow 255
  while (topic.starts_with('/')) topic.remove_prefix(1);
  std::string name;
  for (const char c : topic) {
    if (name.size() >= longest) break;
    if (c == '/') {
      name += '_';
    } else if (is_plain(c) && !(c == '.' && name.empty())) {
      name += c;
    } else {
      name += fmt::format("%{:02X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    }
  }
  if (name.empty()) name += '_';
  std::string unique = name;
  for (int n = 2; !taken_.insert(unique).second; ++n) unique = fmt::format("{}_{}", name, n);
  return unique;
}

Result<void> make_folder(const std::filesystem::path& folder) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (std::filesystem::is_directory(folder, problem)) return {};
  return error(fmt::format("can't make the folder {}: {}", folder.string(),
                           problem ? problem.message() : "a file has that name"),
               write_hint(folder, "name another folder with -o"));
}

namespace {

/// The temporary name of a file until it is complete.
std::filesystem::path draft_of(const std::filesystem::path& file) { return file.string() + ".part"; }

Result<void> write_bytes(const std::filesystem::path& file, const char* bytes, std::size_t size,
                         std::ios::openmode mode) {
  std::ofstream out(file, std::ios::binary | mode);
  out.write(bytes, static_cast<std::streamsize>(size));
  out.close();
  if (!out) return cannot_write(file);
  return {};
}

/// Renames the draft to its file, or removes it if that fails.
Result<void> put_in_place(const std::filesystem::path& file) {
  std::error_code failed;
  std::filesystem::rename(draft_of(file), file, failed);
  if (!failed) return {};
  std::error_code ignored;
  std::filesystem::remove(draft_of(file), ignored);
  return error(fmt::format("can't write {}: {}", file.string(), failed.message()),
               write_hint(file, "name another file with -o"));
}

}  // namespace

Result<void> write_file(const std::filesystem::path& file, std::span<const std::uint8_t> bytes) {
  const auto written =
      write_bytes(draft_of(file), reinterpret_cast<const char*>(bytes.data()), bytes.size(), std::ios::trunc);
  if (written) return put_in_place(file);
  std::error_code ignored;
  std::filesystem::remove(draft_of(file), ignored);
  return written;
}

LineFiles::~LineFiles() {
  std::error_code ignored;
  for (const auto& [file, lines] : held_) std::filesystem::remove(draft_of(file), ignored);
}

Result<void> LineFiles::begin(const std::filesystem::path& file, std::string_view line) {
  held_[file].clear();
  REHEARSE_TRY(write_bytes(draft_of(file), nullptr, 0, std::ios::trunc));
  return append(file, line);
}

Result<void> LineFiles::append(const std::filesystem::path& file, std::string_view line) {
  held_[file] += line;
  size_ += line.size();
  return size_ > max_held ? flush() : Result<void>();
}

Result<void> LineFiles::finish() {
  REHEARSE_TRY(flush());
  while (!held_.empty()) {
    const auto done = held_.extract(held_.begin());
    REHEARSE_TRY(put_in_place(done.key()));
  }
  return {};
}

Result<void> LineFiles::flush() {
  for (auto& [file, lines] : held_) {
    if (lines.empty()) continue;
    REHEARSE_TRY(write_bytes(draft_of(file), lines.data(), lines.size(), std::ios::app));
    lines.clear();
  }
  size_ = 0;
  return {};
}

}  // namespace rehearse
