#include "hosted_language.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <map>

#include "base/hashing.h"
#include "core/guard/own_library.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr HostedLanguage languages[] = {
    {"Python", ".py", "librehearse_python.so",
     "install the package python3-rehearse; a build has it if the packages of tools/setup are installed"},
    {"components", ".so", "ros2/lib/librehearse_guests.so", "a build has it after tools/setup ros2 and tools/ros2",
     true},
};

Result<const LanguageFunctions*> load(const HostedLanguage& language) {
  const fs::path file = own_library_folder() / "rehearse" / language.library;
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored))
    return error(fmt::format("controllers in {} can't run here: {} is missing", language.name, file.string()),
                 std::string(language.advice));
  void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  const auto* functions = handle ? static_cast<const LanguageFunctions*>(dlsym(handle, "rehearse_language")) : nullptr;
  if (!functions) return error(fmt::format("{} can't be loaded: {}", file.string(), dlerror()));
  if (functions->version != language_functions_version)
    return error(fmt::format("{} is of another version of Rehearse", file.string()),
                 "install the same version of both");
  return functions;
}

}  // namespace

std::optional<HostedName> hosted_name(const fs::path& name) {
  const std::string text = name.string();
  for (const HostedLanguage& language : languages) {
    const std::size_t colon = text.rfind(std::string(language.ending) + ":");  // a class may have colons, too
    if (colon != std::string::npos) {
      const std::size_t end = colon + language.ending.size();
      return HostedName{language, text.substr(0, end), text.substr(end + 1)};
    }
    if (!language.is_library && text.ends_with(language.ending)) return HostedName{language, text, ""};
  }
  return std::nullopt;
}

Result<const LanguageFunctions*> functions_of(const HostedLanguage& language) {
  static auto& loaded = *new std::map<std::string_view, const LanguageFunctions*>;
  const auto before = loaded.find(language.ending);
  if (before != loaded.end()) return before->second;
  auto functions = load(language);
  if (functions) loaded[language.ending] = *functions;
  return functions;
}

bool is_controller_file(const fs::path& path) {
  const auto hosted = hosted_name(path);
  std::error_code ignored;
  return fs::is_regular_file(hosted ? hosted->file : path, ignored);
}

std::string hash_of_controller(const fs::path& file) {
  const auto hosted = hosted_name(file);
  if (!hosted) return content_hash_of(file);
  const auto functions = functions_of(hosted->language);
  if (!functions) return content_hash_of(hosted->file);
  RunningHash hash;
  const auto add = [](void* context, const char* path) {
    const std::string content = content_hash_of(path);
    static_cast<RunningHash*>(context)->add(content.data(), content.size());
  };
  (*functions)->list_files(hosted->file.c_str(), add, &hash);
  return hash_text(hash.value());
}

}  // namespace rehearse
