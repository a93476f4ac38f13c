// rehearse new: writes a new project of the user, ready to build.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/write_hint.h"
#include "command.h"
#include "new_project.h"
#include "output.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view workflow_file = ".github/workflows/test.yml";

/// The languages of controllers, and the lines for them in the project's CMakeLists.txt and README.md.
struct Language {
  std::string_view name;
  std::string_view folder;            // of its files in tools/new_project
  std::string_view of_project;        // for project() in CMake
  std::string_view controller;        // adds the controller
  std::string_view source;            // its file
  std::string_view packages;          // of Debian, for its workflow
  std::string_view library = "Hold";  // in the scenario
  bool is_built = true;               // by CMake
};
constexpr Language languages[] = {
    {"c++", "cpp", "CXX", "rehearse_add_simple_controller(Hold hold.cpp)", "hold.cpp", ""},
    {"c", "c", "C CXX", "rehearse_add_simple_controller(Hold hold.c)", "hold.c", ""},
    {"rust", "rust", "CXX", "rehearse_add_rust_controller(Hold Cargo.toml)  # built by cargo", "src/lib.rs", "cargo "},
    {"python", "python", "", "", "hold.py", "", "hold.py:Hold", false},
};

/// The parts of the workflow that depend on how the tests are run.
struct Testing {
  std::string_view package;   // of Rehearse, besides the command
  std::string_view packages;  // of Debian
  std::string_view steps;
  std::string_view output;  // folder
  std::string_view kept;    // paths of the artifact
};
constexpr Testing by_cmake{"rehearse-dev", "cmake g++ make ",
                           "      - name: Build\n"
                           "        run: cmake -S . -B build && cmake --build build\n"
                           "      - name: Test\n"
                           "        run: ctest --test-dir build --output-on-failure --output-junit ctest.xml",
                           "build",
                           "            build/*.xml\n            build/history.html\n            build/traces\n"
                           "            build/goldens/pending"};
constexpr Testing by_pytest{"python3-rehearse", "python3-pytest ",
                            "      - name: Test\n"
                            "        run: python3 -m pytest --junit-xml rehearse-pending/pytest.xml",
                            "rehearse-pending", "            rehearse-pending"};

/// Where the workflow keeps the history of checks.
constexpr std::string_view history_places[] = {"artifact", "branch"};

/// The paragraph of README.md on the workflow.
constexpr std::string_view on_github =
    "\nOn GitHub `.github/workflows/test.yml` runs the tests, and keeps reports, runs that differ, and the history of "
    "margins.\n";

struct NewSettings {
  std::string folder;
  std::string language = std::string(languages[0].name);
  std::string origin;  // the repository of Rehearse; empty: that of this build
  std::string commit;  // of Rehearse; empty: that of this build
  std::string history = std::string(history_places[0]);
  bool workflow_only = false;  // of a project that exists
};

/// The texts that replace those between @ in the files.
struct Replacements {
  std::string project, origin, commit;
  const Language& language;
  std::string history;
  std::string schema;  // of scenarios: the path of the file

  bool has_workflow() const { return !origin.empty() && !commit.empty(); }
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

void replace(std::string& text, std::string_view placeholder, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(placeholder, at)) != std::string::npos; at += by.size())
    text.replace(at, placeholder.size(), by);
}

std::string filled_in(std::string_view text, const Replacements& replacements) {
  std::string filled(text);
  replace(filled, "@PROJECT@", replacements.project);
  replace(filled, "@ORIGIN@", replacements.origin);
  replace(filled, "@COMMIT@", replacements.commit);
  replace(filled, "@LANGUAGES@", std::string(replacements.language.of_project));
  replace(filled, "@CONTROLLER@", std::string(replacements.language.controller));
  replace(filled, "- library: Hold\n", fmt::format("- library: {}\n", replacements.language.library));
  replace(filled, "@SOURCE@", std::string(replacements.language.source));
  const Testing& testing = replacements.language.is_built ? by_cmake : by_pytest;
  replace(filled, "@PACKAGE@", std::string(testing.package));
  replace(filled, "@PACKAGES@", fmt::format("{}{}", replacements.language.packages, testing.packages));
  replace(filled, "@STEPS@", std::string(testing.steps));
  replace(filled, "@OUTPUT@", std::string(testing.output));
  replace(filled, "@KEPT@", std::string(testing.kept));
  replace(filled, "@HISTORY@", replacements.history);
  replace(filled, "@SCHEMA@", replacements.schema);
  replace(filled, "@ON_GITHUB@", replacements.has_workflow() ? std::string(on_github) : "");
  replace(filled, "@CONTENTS@", replacements.history == "branch" ? "write" : "read");
  return filled;
}

/// Checks an address that GitHub's machines fetch from, and that stands between quotes in the workflow.
Result<void> check_origin(const std::string& origin) {
  const auto is_plain = [](char c) { return c > ' ' && c != 0x7f && c != '"' && c != '\\'; };
  const std::size_t scheme = origin.find("://");
  if (scheme != std::string::npos && scheme > 0 && std::ranges::all_of(origin, is_plain)) return {};
  return error(fmt::format("--origin '{}' isn't the address of a repository", origin),
               "expected one that anyone can fetch from, as https://github.com/OWNER/NAME");
}

/// Checks a commit that GitHub's machines fetch. A name would be another commit each day, and the packages that the
/// cache keeps of the first one would stay.
Result<void> check_commit(const std::string& commit) {
  const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  if ((commit.size() == 40 || commit.size() == 64) && std::ranges::all_of(commit, is_digit)) return {};
  return error(fmt::format("--commit '{}' isn't a whole commit", commit),
               "expected 40 digits, as git ls-remote URL HEAD prints them");
}

/// The schema of scenarios, which is installed with the command.
std::string scenario_schema() { return (program_tree() / "share/rehearse/schemas/scenario.json").string(); }

/// What the files of this project are filled in with. Another repository is one of the same commits.
Replacements replacements_of(const NewSettings& settings) {
  const BuiltFrom built = built_from();
  return {project_name(settings.folder),
          settings.origin.empty() ? std::string(built.repository) : settings.origin,
          settings.commit.empty() ? std::string(built.commit) : settings.commit,
          *std::ranges::find(languages, settings.language, &Language::name),
          settings.history,
          scenario_schema()};
}

/// True for an empty folder, and for one that has only the data of git.
bool holds_no_files(const fs::path& folder) {
  std::error_code problem;
  for (fs::directory_iterator entry(folder, problem), end; !problem && entry != end; entry.increment(problem))
    if (entry->path().filename() != ".git") return false;
  return !problem;
}

Result<void> prepare(const fs::path& folder) {
  std::error_code problem;
  if (fs::exists(folder, problem)) {
    if (!fs::is_directory(folder, problem)) return error(fmt::format("{} is not a folder", folder.string()));
    if (!holds_no_files(folder))
      return error(fmt::format("{} is not empty", folder.string()),
                   "name a new folder, an empty one, or a repository without files");
    return {};
  }
  if (!fs::create_directories(folder, problem))
    return error(fmt::format("can't make the folder {}: {}", folder.string(), problem.message()),
                 write_hint(folder, "name another folder"));
  return {};
}

Result<void> write_in_folder(const fs::path& file, const std::string& text) {
  std::error_code ignored;
  fs::create_directories(file.parent_path(), ignored);
  return write_text(file, text);
}

/// The installation prefix for CMake's search; empty if CMake searches there anyway, or if the command isn't installed.
std::string prefix() {
  std::error_code problem;
  const fs::path tree = program_tree();
  if (tree == "/usr" || tree == "/usr/local" || !fs::exists(tree / PACKAGE_BELOW_PREFIX, problem)) return "";
  return tree.string();
}

/// Writes the workflow into a project that exists.
Exit add_workflow(const fs::path& folder, const Replacements& replacements) {
  std::error_code ignored;
  const fs::path target = folder / workflow_file;
  if (!fs::is_directory(folder, ignored)) return refuse(error(fmt::format("there is no folder {}", folder.string())));
  if (replacements.origin.empty())
    return refuse(error("this build doesn't know the address of Rehearse's repository", "--origin URL states it"));
  if (replacements.commit.empty())
    return refuse(error("this build doesn't know its commit, which the workflow names",
                        "--commit COMMIT states it; git ls-remote URL HEAD prints the newest"));
  if (fs::exists(target, ignored))
    return refuse(error_in(target.string(), "there is a workflow", "remove it to have it written anew"));
  for (const ProjectFile& file : new_project_files())
    if (file.path == workflow_file)
      if (const auto written = write_in_folder(target, filled_in(file.text, replacements)); !written)
        return refuse(written.errors());
  fmt::print("{}: {}runs its tests on GitHub, with Rehearse from {}\n", target.string(),
             replacements.language.is_built ? "builds the project and " : "", replacements.origin);
  return Exit::done;
}

/// Removes what an interrupted write_project() has made, but for the data of git.
void remove_project(const fs::path& folder, bool is_new) {
  std::error_code ignored;
  if (is_new) {
    fs::remove_all(folder, ignored);
    return;
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
    if (entry.path().filename() != ".git") fs::remove_all(entry.path(), ignored);
}

/// Writes all files, or none.
Result<void> write_project(const fs::path& folder, const Replacements& replacements, bool has_workflow) {
  const Language& language = replacements.language;
  std::error_code ignored;
  const bool is_new = !fs::exists(folder, ignored);
  REHEARSE_TRY(prepare(folder));
  for (const ProjectFile& file : new_project_files()) {
    if (file.path == workflow_file && !has_workflow) continue;
    const bool is_of_all = file.language.empty() || (file.language == "built" && language.is_built);
    if (!is_of_all && file.language != language.folder) continue;
    auto written = write_in_folder(folder / file.path, filled_in(file.text, replacements));
    if (written) continue;
    remove_project(folder, is_new);
    return written;
  }
  return {};
}

Exit run_new(const NewSettings& settings) {
  const fs::path folder = settings.folder;
  if (!settings.origin.empty())
    if (const auto usable = check_origin(settings.origin); !usable) return refuse(usable.errors());
  if (!settings.commit.empty())
    if (const auto usable = check_commit(settings.commit); !usable) return refuse(usable.errors());
  const Replacements replacements = replacements_of(settings);
  const Language& language = replacements.language;
  if (settings.workflow_only) return add_workflow(folder, replacements);
  const bool has_workflow = replacements.has_workflow();
  if (const auto written = write_project(folder, replacements, has_workflow); !written) return refuse(written.errors());

  const std::string where = prefix();
  fmt::print("{}: a controller, its robot, its scenario and its tests. To {}make its golden:\n\n", folder.string(),
             language.is_built ? "build it and " : "");
  fmt::print("  cd {}\n", shell_word(folder.string()));
  if (language.is_built) {
    fmt::print("  cmake -S . -B build{}\n", where.empty() ? "" : " -D CMAKE_PREFIX_PATH=" + shell_word(where));
    fmt::print(
        "  cmake --build build\n  REHEARSE_GOLDEN=new ctest --test-dir build --output-on-failure\n"
        "  ctest --test-dir build --output-on-failure\n");
  } else {
    fmt::print("  REHEARSE_GOLDEN=new python3 -m pytest\n  python3 -m pytest\n");
  }
  std::fflush(stdout);  // before related output on stderr
  if (!has_workflow)
    fmt::print(stderr,
               "note: it has no workflow for GitHub Actions, as this build doesn't know the {}: rehearse new "
               "--workflow{}{}{} {} writes one\n",
               replacements.origin.empty() ? "address of Rehearse's repository" : "commit of Rehearse",
               language.is_built ? "" : " --language python", replacements.origin.empty() ? " --origin URL" : "",
               replacements.commit.empty() ? " --commit COMMIT" : "", shell_word(folder.string()));
  return Exit::done;
}

std::function<Exit()> declare_new(CLI::App& options) {
  const auto settings = std::make_shared<NewSettings>();
  options.add_option("DIR", settings->folder, "the folder to write, new or empty; it names the project")
      ->required()
      ->type_name("");
  std::vector<std::string> names;
  for (const Language& language : languages) names.emplace_back(language.name);
  options
      .add_option("--language", settings->language, "of the controller: " + fmt::format("{}", fmt::join(names, ", ")))
      ->transform([](std::string name) { return name == "cpp" || name == "cxx" ? std::string("c++") : name; })
      ->check(CLI::IsMember(names))
      ->type_name("NAME");
  options
      .add_option("--origin", settings->origin,
                  "the repository of Rehearse, from which the workflow for GitHub Actions gets its packages or its "
                  "source; without it, the one of which this command was built")
      ->type_name("URL");
  options
      .add_option("--commit", settings->commit,
                  "with --origin: the commit that the workflow builds if there is no release; without it, the one of "
                  "which this command was built")
      ->type_name("COMMIT");
  options
      .add_option("--history", settings->history,
                  "where the workflow keeps the history of checks: artifact (in the cache of GitHub Actions, and in an "
                  "artifact), or branch (rehearse-history, to which it may write then)")
      ->check(CLI::IsMember(std::vector<std::string>(std::begin(history_places), std::end(history_places))))
      ->type_name("PLACE");
  options.add_flag("--workflow", settings->workflow_only,
                   "write only the workflow for GitHub Actions, into a project that exists");
  return [settings] { return run_new(*settings); };
}

}  // namespace

extern const Verb new_verb{"new",
                           "  rehearse new my_walker\n  rehearse new --language rust my_arm\n  rehearse new --workflow "
                           "--origin https://github.com/OWNER/NAME .\n",
                           declare_new};

}  // namespace rehearse::tool
