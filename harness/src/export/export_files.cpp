#include "export/export_files.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

namespace rehearse {
namespace {

Diagnostic cannot_write(const std::filesystem::path& file) {
  return error(fmt::format("can't write {}: {}", file.string(), std::strerror(errno)));
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
                           problem ? problem.message() : "there is something else of that name"));
}

Result<void> write_file(const std::filesystem::path& file, std::span<const std::uint8_t> bytes) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) return cannot_write(file);
  return {};
}

Result<void> LineFiles::begin(const std::filesystem::path& file, std::string_view line) {
  held_[file].clear();
  if (const auto written = write_file(file, {}); !written) return written;
  return append(file, line);
}

Result<void> LineFiles::append(const std::filesystem::path& file, std::string_view line) {
  held_[file] += line;
  size_ += line.size();
  return size_ > max_held ? finish() : Result<void>();
}

Result<void> LineFiles::finish() {
  for (auto& [file, lines] : held_) {
    if (const auto written = flush(file, lines); !written) return written;
  }
  size_ = 0;
  return {};
}

Result<void> LineFiles::flush(const std::filesystem::path& file, std::string& lines) {
  if (lines.empty()) return {};
  std::ofstream out(file, std::ios::binary | std::ios::app);
  out << lines;
  out.close();
  if (!out) return cannot_write(file);
  lines.clear();
  return {};
}

}  // namespace rehearse
