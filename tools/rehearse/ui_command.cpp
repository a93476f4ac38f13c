// rehearse ui: a page beside the editor, which keeps the verdicts of a project's scenarios while its files change.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "command.h"
#include "core/guard/child_process.h"
#include "core/guard/interruption.h"
#include "core/scenario/project.h"
#include "options.h"
#include "output.h"
#include "viewing/ui/project_page.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

struct UiSettings {
  std::string folder = ".";
  std::uint16_t port = 8766;
  std::string editor;
  std::int64_t jobs = 0;  // 0: as many as there are processors
};

/// The list of the projects whose owners have allowed their code to be run; empty: there is no home to keep it in.
fs::path list_of_allowed_projects() {
  const auto stated = [](const char* variable) {
    return std::string(std::getenv(variable) ? std::getenv(variable) : "");
  };
  const std::string home = stated("HOME"), settings = stated("XDG_CONFIG_HOME");
  if (settings.empty() && home.empty()) return {};
  return (settings.empty() ? fs::path(home) / ".config" : fs::path(settings)) / "rehearse/allowed_projects";
}

/// The words of an editor's command, which no shell reads. Fails if {file} isn't among them.
Result<std::vector<std::string>> words_of_editor(const std::string& command) {
  std::vector<std::string> words;
  std::istringstream stream(command);
  for (std::string word; stream >> word;) words.push_back(word);
  if (words.empty()) return words;
  if (command.find("{file}") == std::string::npos)
    return error(fmt::format("the editor's command '{}' has no {{file}} in it", command),
                 "as --editor 'code -g {file}:{line}'");
  if (words[0].find('/') == std::string::npos) {
    const fs::path program = find_program(words[0]);
    if (program.empty()) return error(fmt::format("there is no program {}", words[0]), "--editor names another");
    words[0] = program.string();
  }
  return words;
}

Exit run_ui(const UiSettings& settings) {
  std::error_code failed;
  const fs::path folder = fs::canonical(settings.folder, failed);
  if (failed || !fs::is_directory(folder, failed))
    return refuse(error(fmt::format("there is no folder {}", settings.folder), "name a project's folder"));
  const auto project = find_project(folder / "");
  if (!project)
    return refuse(error(fmt::format("{} is of no project", folder.string()),
                        "a project has a folder golden, a CMakeLists.txt, a pyproject.toml or a pytest.ini; rehearse "
                        "new begins one"));
  fs::current_path(*project, failed);  // where paths of the project begin
  ProjectPageOptions options;
  options.checks.project = *project;
  options.checks.command = program_tree() / "bin/rehearse";
  options.checks.allowed = list_of_allowed_projects();
  options.checks.jobs =
      settings.jobs > 0 ? static_cast<std::size_t>(settings.jobs) : std::max(1U, std::thread::hardware_concurrency());
  options.port = settings.port;
  const auto editor = words_of_editor(settings.editor);
  if (!editor) return refuse(editor.errors());
  options.editor = *editor;
  const auto page = ProjectPage::open(std::move(options));
  if (!page) return refuse(page.errors());
  end_runs_on_signals();
  fmt::print("the page of {}: {}\n", project->string(), (*page)->address());
  fmt::print("Ctrl-C ends it\n");
  std::fflush(stdout);
  while (interruption() == 0) (*page)->step();
  (*page)->stop();
  return Exit::done;
}

std::function<Exit()> declare_ui(CLI::App& options) {
  const auto settings = std::make_shared<UiSettings>();
  options.add_option("FOLDER", settings->folder, "a folder of the project (the working folder)")->type_name("");
  add_integer(options, "--port", "listen on this port of this machine; 0: on any free one (8766)", 0, 65535,
              [=](std::int64_t port) { settings->port = static_cast<std::uint16_t>(port); });
  options
      .add_option("--editor", settings->editor,
                  "the program that opens a place in a file, as 'code -g {file}:{line}'. No shell reads it")
      ->type_name("WORDS");
  add_integer(options, "-j,--jobs", "scenarios to check at a time (one for each processor)", 1, 1024,
              [=](std::int64_t jobs) { settings->jobs = jobs; });
  return [settings] { return run_ui(*settings); };
}

}  // namespace

extern const Verb ui_verb{"ui",
                          "  rehearse ui\n"
                          "  rehearse ui my_robot --port 0\n"
                          "  rehearse ui --editor 'code -g {file}:{line}'\n",
                          declare_ui};

}  // namespace rehearse::tool
