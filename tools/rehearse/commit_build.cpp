#include "commit_build.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/guard/child_process.h"
#include "output.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

Result<ProgramOutput> run(std::vector<std::string> words) {
  words[0] = find_program(words[0]).string();
  return output_of({std::move(words), environment_with({}), {}});
}

/// The last 12 lines.
std::string end_of(const std::string& text) {
  std::size_t begin = text.size();
  for (int lines = 0; lines < 12 && begin > 0 && begin != std::string::npos; ++lines)
    begin = text.rfind('\n', begin - 1);
  return begin == std::string::npos || text.empty() ? text : text.substr(begin);
}

Result<std::string> run_or_fail(std::vector<std::string> words, const std::string& what) {
  const std::string program = words[0];
  if (find_program(program).empty()) return error(fmt::format("{}: there is no {} on the PATH", what, program));
  const auto output = REHEARSE_TRY(run(std::move(words)));
  if (output.status != 0)
    return error(fmt::format("{} fails: {}", what, plain_text(end_of(output.text))),
                 "build that commit yourself, and name its library: --beside OLD.so");
  return output.text;
}

/// What git rev-parse prints for these words, in the working folder.
Result<std::string> rev_parse(std::vector<std::string> words) {
  words.insert(words.begin(), {"git", "rev-parse"});
  auto text = run_or_fail(std::move(words), "git rev-parse");
  while (text && !text->empty() && text->back() == '\n') text->pop_back();
  return text;
}

/// Builds the project in the new folder `build`, and finds the library there. Its target usually has its name, and
/// tests then aren't built.
Result<fs::path> build_library(const fs::path& sources, const fs::path& build, const fs::path& library,
                               const std::string& what) {
  // without a number make starts all compilers at once
  const std::vector<std::string> compile{"cmake", "--build", build.string(), "--parallel",
                                         std::to_string(std::max(1U, std::thread::hardware_concurrency()))};
  std::vector<std::string> compile_target = compile;
  compile_target.insert(compile_target.end(), {"--target", library.stem().string()});
  REHEARSE_TRY(run_or_fail({"cmake", "-S", sources.string(), "-B", build.string(), "-DCMAKE_BUILD_TYPE=Debug"}, what));
  if (!run_or_fail(compile_target, what)) REHEARSE_TRY(run_or_fail(compile, what));
  std::error_code failed;
  std::vector<fs::path> found;
  for (auto file = fs::recursive_directory_iterator(build, failed); !failed && file != fs::end(file);
       file.increment(failed))
    if (file->path().filename() == library.filename()) found.push_back(file->path());
  if (found.empty()) return error(fmt::format("{} made no {}", what, library.filename().string()));
  return *std::ranges::min_element(found);
}

/// The folder of the repository that has the user's CMake project: the working folder, if it has a CMakeLists.txt, or
/// the top folder. Relative to the top folder.
Result<fs::path> project_below(const fs::path& top) {
  const auto inner = REHEARSE_TRY(rev_parse({"--show-prefix"}));
  std::error_code ignored;
  return fs::exists(top / inner / "CMakeLists.txt", ignored) ? fs::path(inner) : fs::path();
}

}  // namespace

bool is_commit(const std::string& word) {
  if (find_program("git").empty() || word.starts_with("-")) return false;
  const auto output = run({"git", "rev-parse", "--verify", "--quiet", word + "^{commit}"});
  return output && output->status == 0;
}

Result<fs::path> build_of_commit(const std::string& commit, const fs::path& library, const fs::path& folder) {
  const auto top = REHEARSE_TRY(rev_parse({"--show-toplevel"}));
  const auto number = REHEARSE_TRY(rev_parse({"--verify", commit + "^{commit}"}));
  const auto project = REHEARSE_TRY(project_below(top));
  const std::string what = "the build of " + commit;
  const fs::path sources = folder / "old";
  const std::vector<std::vector<std::string>> steps{
      {"git", "clone", "--quiet", "--no-checkout", "--shared", top, sources.string()},
      {"git", "-C", sources.string(), "checkout", "--quiet", "--detach", number}};
  for (const std::vector<std::string>& step : steps) REHEARSE_TRY(run_or_fail(step, what));
  return build_library(sources / project, folder / "old-build", library, what);
}

Result<fs::path> build_of_sources(const fs::path& library, const fs::path& folder) {
  const auto top = REHEARSE_TRY(rev_parse({"--show-toplevel"}));
  const auto project = REHEARSE_TRY(project_below(top));
  return build_library(fs::path(top) / project, folder / "new-build", library, "the build of the present sources");
}

}  // namespace rehearse::tool
