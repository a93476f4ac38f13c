#include "controller_library.h"

#include <cnoid/SimpleController>

#include <cxxabi.h>
#include <dlfcn.h>
#include <fmt/format.h>
#include <rehearse/c_controller.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "base/hashing.h"
#include "base/names.h"
#include "body_loading.h"
#include "core/guard/exception_text.h"
#include "core/guard/guarded_call.h"
#include "core/guard/own_library.h"
#include "core/guard/process_end.h"
#include "core/guard/supervisor.h"
#include "core/scenario/project.h"
#include "hosted_language.h"
#include "loaded_libraries.h"
#include "sanitizer.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

// AddressSanitizer replaces the functions in which threads take turns, so in a build with it they are free.
#if defined(__has_feature)
constexpr bool is_sanitized = __has_feature(address_sanitizer);
#elif defined(__SANITIZE_ADDRESS__)
constexpr bool is_sanitized = true;
#else
constexpr bool is_sanitized = false;
#endif

constexpr const char* factory_name = "createSimpleController";
constexpr const char* abi_name = "rehearseCnoidAbi";
constexpr const char* c_functions_name = "rehearse_controller";

/// The folder of the controllers in the build, or the installation, of Rehearse.
fs::path own_controllers() { return own_library_folder() / "rehearse" / "controllers"; }

/// The folders of an environment variable, separated by colons.
std::vector<fs::path> folders_in(const char* variable) {
  std::vector<fs::path> folders;
  if (const char* listed = std::getenv(variable)) {
    std::string_view rest = listed;
    while (!rest.empty()) {
      const std::size_t colon = rest.find(':');
      if (colon != 0) folders.emplace_back(rest.substr(0, colon));
      rest = colon == std::string_view::npos ? std::string_view() : rest.substr(colon + 1);
    }
  }
  return folders;
}

bool is_inside(const fs::path& path, const fs::path& folder) {
  const fs::path relative = path.lexically_relative(folder);
  return !relative.empty() && *relative.begin() != "..";
}

/// The folders of controllers of a project's builds; the folder with the newest library of that name comes first.
std::vector<fs::path> built_folders(const fs::path& project, const std::string& name) {
  std::vector<fs::path> folders;
  for (const fs::path& build : build_folders(project)) folders.push_back(build / "lib/rehearse/controllers");
  std::ranges::stable_sort(folders, std::greater(), [&](const fs::path& folder) {
    std::error_code missing;
    const auto written = fs::last_write_time(folder / (name + ".so"), missing);
    return missing ? fs::file_time_type::min() : written;
  });
  return folders;
}

/// The folders in which a controller is searched by its name: the user's folders, the builds of the project, the folder
/// of this installation. A program that runs from a build of the project uses controllers of that build alone. Other
/// controllers may be made with different compilers, or with sanitizers.
std::vector<fs::path> search_folders(const std::string& name, const fs::path& directory) {
  const fs::path own = own_controllers();
  std::vector<fs::path> folders = folders_in("REHEARSE_CONTROLLER_PATH");
  for (const fs::path& inside : {directory / "", fs::current_path() / ""}) {
    const auto project = find_project(inside);
    if (!project || is_inside(own, *project)) continue;
    for (const fs::path& folder : built_folders(*project, name))
      if (std::ranges::find(folders, folder) == folders.end()) folders.push_back(folder);
  }
  folders.push_back(own);
  return folders;
}

std::array<std::string, 2> names_of_file(const std::string& name) { return {name + ".so", "lib" + name + ".so"}; }

/// The file in that folder that a name stands for; empty: it has none.
fs::path file_in(const fs::path& folder, const std::string& name) {
  for (const std::string& file : names_of_file(name))
    if (is_controller_file(folder / file)) return folder / file;
  return {};
}

/// CMAKE_BUILD_TYPE of a build; empty: it states none.
std::string build_type_of(const fs::path& build) {
  constexpr std::string_view key = "CMAKE_BUILD_TYPE:STRING=";
  std::ifstream cache(build / "CMakeCache.txt");
  for (std::string line; std::getline(cache, line);)
    if (line.starts_with(key)) return line.substr(key.size());
  return {};
}

/// "build-debug (Debug, AddressSanitizer)", of the build that has the library.
std::string build_text(const fs::path& library) {
  const fs::path build = library.parent_path() / "../../..";
  std::string facts = build_type_of(build);
  for (const Sanitizer& sanitizer : sanitizers_of(library))
    facts += (facts.empty() ? "" : ", ") + std::string(sanitizer.name);
  std::error_code ignored;
  const std::string folder = fs::proximate(build.lexically_normal(), ignored).string();
  return facts.empty() ? folder : fmt::format("{} ({})", folder, facts);
}

/// A sanitizer that doesn't let this process load the library; none: it can be loaded.
std::optional<Sanitizer> unloadable_sanitizer(const fs::path& library) {
  for (const Sanitizer& sanitizer : sanitizers_of(library))
    if (sanitizer.comes_first && !is_in_process(sanitizer)) return sanitizer;
  return std::nullopt;
}

std::string sanitizer_advice(const Sanitizer& sanitizer) {
  const std::string build = fmt::format("build it without -fsanitize={}", sanitizer.word);
  if (sanitizer.runtime.empty()) return build;
  return fmt::format("{}, or preload the runtime: LD_PRELOAD=$(gcc -print-file-name={}) rehearse ...", build,
                     sanitizer.runtime);
}

/// Advice about a missing controller.
std::string advice_on_missing(const std::string& looked, const fs::path& directory) {
  const auto project = find_project(directory / "");
  if (project && build_folders(*project).empty()) {
    std::error_code ignored;
    const std::string source = fs::proximate(*project, ignored).string();
    const std::string build = fs::proximate(*project / "build", ignored).string();
    return fmt::format("build it first: cmake -S {0} -B {1} && cmake --build {1}", source, build);
  }
  return "looked for " + looked + "; REHEARSE_CONTROLLER_PATH names further folders";
}

bool is_path(const std::string& name) {
  return name.find('/') != std::string::npos || name.ends_with(".so") || hosted_name(name);
}

/// The places of a controller whose name is a path. The name of a file alone, of a hosted language, is also searched in
/// the folder of the project: it is a source, and a project's sources needn't be beside its scenarios. A library is
/// also searched where the dynamic linker does.
std::vector<fs::path> places_of_path(const std::string& name, const fs::path& directory) {
  std::vector<fs::path> places{directory / name, fs::current_path() / name};
  if (places[0].lexically_normal() == places[1].lexically_normal()) places.pop_back();
  if (name.find('/') != std::string::npos || !hosted_name(name)) return places;
  for (const fs::path& inside : {directory / "", fs::current_path() / ""})
    if (const auto project = find_project(inside)) places.push_back(*project / name);
  if (hosted_name(name)->file.extension() == ".so")
    for (const fs::path& folder : folders_in("LD_LIBRARY_PATH")) places.push_back(folder / name);
  return places;
}

/// The dynamic linker's message, with demangled C++ names.
std::string readable(std::string message) {
  constexpr std::string_view marker = "undefined symbol: ";
  const std::size_t at = message.find(marker);
  if (at == std::string::npos) return message;
  std::string symbol = message.substr(at + marker.size());
  symbol = symbol.substr(0, symbol.find_first_of(" \t\n,("));
  int status = 0;
  char* demangled = abi::__cxa_demangle(symbol.c_str(), nullptr, nullptr, &status);
  if (status == 0 && demangled) symbol = demangled;
  std::free(demangled);
  return "it needs the symbol '" + symbol + "', which nothing here defines";
}

/// The changes that the library made to the process while it was loaded. A library that is in memory already makes no
/// changes. Then the changes of its first load are returned, so that the remarks of a run don't depend on earlier runs.
std::vector<std::string> remarks_on_loading(const std::string& name, const std::string& content_hash,
                                            const CallOutcome& outcome) {
  static auto& told = *new std::map<std::string, std::vector<std::string>>;
  std::vector<std::string> remarks;
  if (outcome.changed_float_mode)
    remarks.push_back(fmt::format("{} switches the whole process to {} when it is loaded{}; it was set back", name,
                                  describe(outcome.float_mode),
                                  is_fast_math(outcome.float_mode) ? ": it was linked with -ffast-math" : ""));
  for (const Trespass& trespass : ProcessGuard::instance().put_right())
    remarks.push_back(fmt::format("{}, while it was loaded, {}", name, trespass.deed));
  if (!remarks.empty()) told[content_hash] = remarks;
  const auto before = told.find(content_hash);
  return before == told.end() ? remarks : before->second;
}

/// The libraries of this process that were interrupted while they were loaded or unloaded, by file, with a description.
/// The dynamic linker treats such a library as loaded, although its static objects weren't constructed, or were
/// destroyed.
std::map<fs::path, std::string>& interrupted_libraries() {
  static auto& all = *new std::map<fs::path, std::string>;
  return all;
}

}  // namespace

Result<fs::path> find_controller_library(const std::string& name, const fs::path& directory) {
  std::vector<fs::path> candidates;
  if (is_path(name)) {
    candidates = places_of_path(name, directory);
  } else {
    for (const fs::path& folder : search_folders(name, directory))
      for (const std::string& file : names_of_file(name)) candidates.push_back(folder / file);
  }
  std::string looked;
  for (const fs::path& candidate : candidates) {
    if (is_controller_file(candidate)) return candidate;
    looked += (looked.empty() ? "" : ", ") + candidate.lexically_normal().string();
  }
  return error("controller library '" + name + "' not found",
               is_path(name) ? "looked for " + looked : advice_on_missing(looked, directory));
}

std::string note_on_builds(const std::string& name, const fs::path& directory) {
  if (is_path(name)) return {};
  const auto chosen = find_controller_library(name, directory);
  if (!chosen) return {};
  std::vector<fs::path> builds;
  for (const fs::path& inside : {directory / "", fs::current_path() / ""})
    if (const auto project = find_project(inside))
      for (const fs::path& folder : built_folders(*project, name))
        if (fs::path file = file_in(folder, name); !file.empty() && std::ranges::find(builds, file) == builds.end())
          builds.push_back(std::move(file));
  const auto taken = std::ranges::find(builds, *chosen);
  const auto is_chosen = [&](const fs::path& folder) { return folder == chosen->parent_path(); };
  const bool is_stated = std::ranges::any_of(folders_in("REHEARSE_CONTROLLER_PATH"), is_chosen);
  const bool is_of_own_build = is_chosen(own_controllers());  // others aren't searched
  if (taken == builds.end() || builds.size() < 2 || is_stated || is_of_own_build) return {};
  builds.erase(taken);
  std::vector<std::string> others;
  for (const fs::path& file : builds) others.push_back(build_text(file));
  return fmt::format("{} is taken from {}, where it is newest; also in: {}", chosen->filename().string(),
                     build_text(*chosen), listed(others, 4));
}

Result<std::shared_ptr<ControllerLibrary>> ControllerLibrary::open(const fs::path& file, const std::string& label,
                                                                   double call_limit, const ThreadRules& threads) {
  std::shared_ptr<ControllerLibrary> library(new ControllerLibrary);
  library->threads_->are_free = threads.are_free || is_sanitized;
  for (const auto& [name, delay] : threads.delays) library->threads_->delays[name] = std::llround(delay * 1e9);
  library->file_ = file;
  library->label_ = label;
  library->call_limit_ = call_limit;
  const auto hosted = hosted_name(file);
  if (!hosted) library->content_hash_ = content_hash_of(file);
  const fs::path absolute = fs::absolute(file);  // before the call, because the call may end at any instruction
  const std::string name = "controller library '" + file.filename().string() + "'";
  if (const auto before = interrupted_libraries().find(absolute); before != interrupted_libraries().end())
    return error(name + " can't be loaded again in this process: before, it " + before->second,
                 "its static objects are incomplete; another process can load it");
  if (const auto sanitizer = hosted ? std::nullopt : unloadable_sanitizer(absolute))
    return error(
        fmt::format("{} is built with {}, whose runtime must be loaded before this program", name, sanitizer->name),
        sanitizer_advice(*sanitizer));
  std::string problem;
  LanguageProblem hosted_problem;
  register_body_loader();
  note_own_libraries();
  // Its static objects are constructed here: code of the library's author.
  ProcessGuard::instance().begin(library->threads_, true);
  const CallOutcome outcome = guarded_call(
      [&] {
        if (hosted) {
          hosted_problem = library->load_hosted(*hosted);
          return;
        }
        library->handle_ = dlopen(absolute.c_str(), RTLD_NOW | RTLD_LOCAL);
        if (!library->handle_) problem = dlerror();
      },
      call_limit);
  library->remarks_ = remarks_on_loading(name, library->content_hash_, outcome);
  if (outcome.end != CallEnd::returned) {
    library->keep_loaded();
    interrupted_libraries()[absolute] = "failed while it was loaded: it " + outcome.what;
    return error(name + " failed while it was loaded: it " + outcome.what);
  }
  if (hosted) {
    if (hosted_problem.message.empty()) {
      if (void* const handle = library->language_->handle ? library->language_->handle(library->hosted_) : nullptr)
        library->take_links(handle);
      return library;
    }
    Diagnostic refused = error_in(hosted_problem.file, text_of_controller(hosted_problem.message), hosted_problem.hint);
    refused.line = hosted_problem.line;
    return refused;
  }
  if (!library->handle_) {
    if (problem.find("invalid ELF header") != std::string::npos || problem.find("file too short") != std::string::npos)
      return error(name + " is not a shared library", "build it with rehearse_add_simple_controller or -shared -fPIC");
    return error(name + " can't be loaded: " + readable(problem));
  }
  library->take_links(library->handle_);
  library->factory_ = reinterpret_cast<Factory>(dlsym(library->handle_, factory_name));
  library->c_functions_ = static_cast<const rehearse_controller_functions*>(dlsym(library->handle_, c_functions_name));
  if (!library->factory_ && !library->c_functions_)
    return error(name + " is not a controller: it defines neither " + factory_name + " nor " + c_functions_name,
                 "end its source with CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(YourClass); in C, see "
                 "<rehearse/controller.h>");
  if (!library->factory_) {
    if (const std::string unusable = problem_of(*library->c_functions_); !unusable.empty())
      return error(name + " can't be used: " + unusable, "see <rehearse/controller.h> of this version");
    return library;
  }
  const auto abi = reinterpret_cast<int (*)()>(dlsym(library->handle_, abi_name));
  if (!abi || abi() != REHEARSE_CNOID_ABI)
    return error(name +
                     (abi ? " was compiled with the <cnoid/...> headers of another version of Rehearse"
                          : " was not compiled with Rehearse's <cnoid/...> headers") +
                     ", whose classes have another memory layout",
                 "compile it again with the headers of this version");
  return library;
}

void ControllerLibrary::take_links(void* handle) {
  linked_ = linked_libraries(handle);
  threads_->from_start = can_start_threads(handle);
}

LanguageProblem ControllerLibrary::load_hosted(const HostedName& name) {
  LanguageProblem problem;
  if (name.entry.empty()) {
    problem.message = fmt::format("'{}' names no class", name.file.string());
    problem.hint = fmt::format("write the class behind it: {}:Hold", name.file.filename().string());
    return problem;
  }
  const auto functions = functions_of(name.language);
  if (!functions) {
    problem.message = functions.errors()[0].message;
    problem.hint = functions.errors()[0].hint;
    return problem;
  }
  const fs::path file = fs::absolute(name.file);
  void* const loaded = (*functions)->load(file.c_str(), name.entry.c_str(), problem);
  if (!loaded) return problem;
  language_ = *functions;
  hosted_ = loaded;
  content_hash_ = hash_of_controller(file.string() + ":" + name.entry);
  return problem;
}

cnoid::SimpleController* ControllerLibrary::create() const {
  if (language_) return make_c_controller(*language_->functions(hosted_));
  return factory_ ? factory_() : make_c_controller(*c_functions_);
}

void ControllerLibrary::keep_loaded() {
  if (!std::exchange(keep_loaded_, true)) guard_process_end(label_, call_limit_);
}

ControllerLibrary::~ControllerLibrary() {
  if (!handle_ && !hosted_) return;
  if (!keep_loaded_) unload();
  guard_process_end(label_, call_limit_);
}

void ControllerLibrary::unload() {
  // Its static objects are destroyed here. Changes that they make to the process are undone but not reported.
  note_call_begin(label_.c_str(), unloading, 0, 0.0, call_limit_);
  ProcessGuard::instance().begin(threads_, true);
  const CallOutcome outcome = guarded_call(
      [&] {
        if (language_)
          language_->unload(hosted_);
        else
          dlclose(handle_);
      },
      call_limit_);
  ProcessGuard::instance().put_right();
  note_call_end();
  if (outcome.end == CallEnd::returned) return;
  interrupted_libraries()[fs::absolute(file_)] = "failed while it was unloaded: it " + outcome.what;
  fmt::print(stderr, "warning: controller library '{}' failed while it was unloaded: it {}\n",
             file_.filename().string(), outcome.what);
}

}  // namespace rehearse
