#include "certificates.h"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

#include "replay/plant_level.h"
#include "trace/hashing.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

std::string content_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

fs::path Certificates::file_for(const std::string& facts) const {
  return folder_ / (subject_ + "-" + hash_text(hash_bytes(facts.data(), facts.size())));
}

bool Certificates::has(const std::string& facts) const { return content_of(file_for(facts)) == facts; }

Result<void> Certificates::add(const std::string& facts) const {
  const fs::path file = file_for(facts);
  if (auto made = make_folder_of(file); !made) return made;
  const fs::path whole = fs::path(file).concat(fmt::format(".{}", getpid()));
  std::ofstream stream(whole, std::ios::binary);
  stream << facts;
  stream.close();
  std::error_code failed;
  fs::rename(whole, file, failed);
  if (stream && !failed) return {};
  return error(fmt::format("{} can't be written", file.string()));
}

std::vector<std::string> Certificates::all() const {
  std::vector<std::string> facts;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, failed))
    if (entry.path().filename().string().starts_with(subject_ + "-")) facts.push_back(content_of(entry.path()));
  return facts;
}

}  // namespace rehearse
