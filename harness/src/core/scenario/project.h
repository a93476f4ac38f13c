// A project: the folder of scenarios, their goldens and their controllers.
//
// The command, the tests and RehearseControllers.cmake share this rule. The project of a file is the nearest folder
// above it that has a folder `golden`, else the nearest that has a CMakeLists.txt, a pyproject.toml or a pytest.ini.
// Its scenarios are the *.yaml below `scenarios` and `fixtures/scenarios`, its goldens are in `golden`. The failures
// that it keeps are the *.yaml below `failures` and `fixtures/failures`. Its controllers are in
// `lib/rehearse/controllers` of its builds: the folders `build*`, others with a CMakeCache.txt, and those of presets,
// as `out/build/release`.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

/// The project of a file, or of a folder: for "walk/" and for "walk/run.yaml" it is `walk` or a folder above it. None:
/// no folder above has one of these.
std::optional<std::filesystem::path> find_project(const std::filesystem::path& inside);

/// All files that may be scenarios of a project, by path.
std::vector<std::filesystem::path> scenario_files(const std::filesystem::path& project);

/// The scenarios that have failed once, as `sweep shrink` writes them, by path.
std::vector<std::filesystem::path> failure_files(const std::filesystem::path& project);

/// False if the text of the file has neither the word of `golden:` nor that of `expect:`. A file that can't be read may
/// be a scenario with a mistake.
bool may_be_checked(const std::filesystem::path& file);

/// The golden that a file of a scenario names; empty: none, or the file can't be read.
std::string golden_in(const std::filesystem::path& file);

/// The folders of a project's builds, by name.
std::vector<std::filesystem::path> build_folders(const std::filesystem::path& project);

}  // namespace rehearse
