#include "code_hashes.h"

#include <fmt/format.h>
#include <rehearse/pin.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string_view>

#include "base/file_identity.h"
#include "base/hashing.h"
#include "base/user_cache.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using Libraries = std::map<std::string, LoadedLibrary>;
using Hashes = std::map<std::string, std::string>;  // by the names of libraries

constexpr std::size_t digits = 16;  // of a hash

std::string hash_of_text(std::string_view text) { return hash_text(hash_bytes(text.data(), text.size())); }

/// States which files these are, and that they are unchanged. Empty: a file could be changed without a change of this
/// text. A file system in an image may have the same times and inodes as another one, hence the build identifiers;
/// devices and inodes may have other meanings on another machine, hence the identifier of the machine's start.
std::string identity_of(const Libraries& libraries) {
  constexpr std::chrono::seconds settled{2};
  std::ifstream boot("/proc/sys/kernel/random/boot_id");
  std::string text{std::istreambuf_iterator<char>(boot), {}};
  if (text.empty()) return {};
  for (const auto& [name, library] : libraries) {
    const auto file = FileIdentity::of(library.file.empty() ? "/proc/self/exe" : library.file);
    const bool is_known = file && file->inode == library.inode && !library.build_id.empty();
    if (!is_known || !file->is_older_than(settled)) return {};
    text +=
        fmt::format("{} {} {} {} {} {} ", name, file->device, file->inode, file->size, file->modified, file->changed);
    for (const char byte : library.build_id) text += fmt::format("{:02x}", static_cast<unsigned char>(byte));
    text += '\n';
  }
  return text;
}

/// The file of the hashes of a program and its libraries. Empty: nothing is kept.
fs::path file_for(const Libraries& libraries) {
  const fs::path cache = user_cache();
  if (cache.empty()) return {};
  std::string names = own_program().string();
  for (const auto& entry : libraries) names += '\n' + entry.first;
  return cache / "code" / hash_of_text(names);
}

/// A file has the identity, the hashes in the order of the libraries, and the hash of both.
std::optional<Hashes> find(const fs::path& file, const std::string& identity, const Libraries& libraries) {
  const std::string text = read_from_cache(file).value_or("");
  if (text.size() != identity.size() + digits * (libraries.size() + 1) || !text.starts_with(identity)) return {};
  if (hash_of_text(std::string_view(text).substr(0, text.size() - digits)) != text.substr(text.size() - digits))
    return {};
  Hashes hashes;
  std::size_t at = identity.size();
  for (const auto& entry : libraries) {
    hashes.emplace(entry.first, text.substr(at, digits));
    at += digits;
  }
  return hashes;
}

void keep(const fs::path& file, std::string text, const Hashes& hashes) {
  for (const auto& entry : hashes) text += entry.second;
  keep_in_cache(file, text + hash_of_text(text));
}

}  // namespace

Result<Hashes> code_hashes_of(const Libraries& libraries) {
  const fs::path file = file_for(libraries);
  const std::string identity = file.empty() ? "" : identity_of(libraries);
  if (!identity.empty())
    if (auto kept = find(file, identity, libraries)) return *std::move(kept);
  Hashes hashes;
  for (const auto& [name, library] : libraries) {
    const auto hash = REHEARSE_TRY(code_hash_of(library));
    hashes.emplace(name, hash);
  }
  if (!identity.empty() && identity_of(libraries) == identity) keep(file, identity, hashes);
  return hashes;
}

}  // namespace rehearse
