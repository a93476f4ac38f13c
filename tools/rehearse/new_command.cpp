// rehearse new: writes a new project of the user, ready to build.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "command.h"
#include "model/write_hint.h"
#include "new_project.h"
#include "output.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

struct NewSettings {
  std::string folder;
};

/// The folder's name, with '_' instead of characters that a CMake project's name can't contain.
std::string project_name(const fs::path& folder) {
  std::string name = fs::absolute(folder / "x").lexically_normal().parent_path().filename().string();
  for (char& c : name) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    if (!is_plain && c != '-') c = '_';
  }
  return name.empty() ? "controllers" : name;
}

std::string filled_in(std::string_view text, const std::string& name) {
  constexpr std::string_view placeholder = "@PROJECT@";
  std::string filled(text);
  for (std::size_t at = 0; (at = filled.find(placeholder, at)) != std::string::npos; at += name.size())
    filled.replace(at, placeholder.size(), name);
  return filled;
}

Result<void> prepare(const fs::path& folder) {
  std::error_code problem;
  if (fs::exists(folder, problem)) {
    if (!fs::is_directory(folder, problem)) return error(fmt::format("{} is not a folder", folder.string()));
    if (!fs::is_empty(folder, problem) || problem)
      return error(fmt::format("{} is not empty", folder.string()), "name a new folder, or an empty one");
    return {};
  }
  if (!fs::create_directories(folder, problem))
    return error(fmt::format("can't make the folder {}: {}", folder.string(), problem.message()),
                 write_hint(folder, "name another folder"));
  return {};
}

Result<void> write(const fs::path& file, const std::string& text) {
  std::error_code ignored;
  fs::create_directories(file.parent_path(), ignored);
  return write_text(file, text);
}

/// The installation prefix for CMake's search; empty if CMake searches there anyway, or if the command isn't installed.
std::string prefix() {
  std::error_code problem;
  const fs::path self = fs::read_symlink("/proc/self/exe", problem);
  const fs::path above = self.parent_path().parent_path();
  if (problem || above == "/usr" || above == "/usr/local" || !fs::exists(above / PACKAGE_BELOW_PREFIX)) return "";
  return above.string();
}

Exit run_new(const NewSettings& settings) {
  const fs::path folder = settings.folder;
  if (const auto prepared = prepare(folder); !prepared) return refuse(prepared.errors());
  const std::string name = project_name(folder);
  for (const ProjectFile& file : new_project_files())
    if (const auto written = write(folder / file.path, filled_in(file.text, name)); !written)
      return refuse(written.errors());

  const std::string where = prefix();
  fmt::print("{}: a controller, its robot, its scenario and its tests. To build it and make its golden:\n\n",
             folder.string());
  fmt::print("  cd {}\n", shell_word(folder.string()));
  fmt::print("  cmake -S . -B build{}\n", where.empty() ? "" : " -D CMAKE_PREFIX_PATH=" + shell_word(where));
  fmt::print(
      "  cmake --build build\n  REHEARSE_GOLDEN=new ctest --test-dir build --output-on-failure\n"
      "  ctest --test-dir build --output-on-failure\n");
  return Exit::done;
}

std::function<Exit()> declare_new(CLI::App& options) {
  const auto settings = std::make_shared<NewSettings>();
  options.add_option("DIR", settings->folder, "the folder to write, new or empty; it names the project")
      ->required()
      ->type_name("");
  return [settings] { return run_new(*settings); };
}

}  // namespace

const Verb new_verb{"new", "  rehearse new my_walker\n", declare_new};

}  // namespace rehearse::tool
