#include "recorded_files.h"

#include <stdlib.h>

#include <cnoid/ExecutablePath>
#include <fstream>
#include <string_view>

#include "core/guard/opened_files.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view of_share = "share/";  // folder below the prefix of copies

/// False for a name that leads out of its folder: it isn't the name of a copy.
bool is_inside(const fs::path& name) {
  for (const fs::path& part : name)
    if (part == "..") return false;
  return name.is_relative() && !name.empty();
}

}  // namespace

RecordedFiles::RecordedFiles(const mcap::Reader& recording) {
  std::map<std::string, std::string> copies;
  bool is_share_missing = false, has_others = false;
  std::error_code ignored;
  for (const mcap::Attachment& attachment : recording.attachments()) {
    if (!attachment.name.starts_with(input_copies_prefix)) continue;
    const std::string name = attachment.name.substr(input_copies_prefix.size());
    if (!is_inside(name)) continue;
    copies[name] = attachment.text();
    if (name.starts_with(of_share))
      is_share_missing |= !fs::exists(cnoid::shareDirPath() / name.substr(of_share.size()), ignored);
    else
      has_others = true;
  }
  if (!is_share_missing && !has_others) return;
  std::string path = (fs::temp_directory_path(ignored) / "rehearse.XXXXXX").string();
  if (mkdtemp(path.data()) == nullptr) return;
  folder_ = path;
  for (const auto& [name, text] : copies) {
    const fs::path place = folder_ / name;
    fs::create_directories(place.parent_path(), ignored);
    const fs::path present =
        name.starts_with(of_share) ? cnoid::shareDirPath() / name.substr(of_share.size()) : fs::path();
    if (!present.empty() && fs::is_regular_file(present, ignored))
      fs::copy_file(present, place, ignored);
    else
      std::ofstream(place, std::ios::binary) << text;
  }
  if (is_share_missing) set("REHEARSE_CHOREONOID_SHARE", folder_ / "share");
  if (has_others) set("REHEARSE_RECORDED_FILES", folder_);
}

void RecordedFiles::set(const char* variable, const fs::path& value) {
  const char* before = getenv(variable);
  before_[variable] = before == nullptr ? std::nullopt : std::optional<std::string>(before);
  setenv(variable, value.c_str(), 1);
}

RecordedFiles::~RecordedFiles() {
  for (const auto& [variable, value] : before_)
    value ? setenv(variable.c_str(), value->c_str(), 1) : unsetenv(variable.c_str());
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

}  // namespace rehearse
