#include "line_advice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/golden.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "core/guard/child_process.h"
#include "core/host/controller_library.h"
#include "core/host/hosted_language.h"
#include "core/scenario/trace_scenario.h"
#include "debugger.h"
#include "output.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

/// The commit in which the file got its present content; empty: git has none.
std::string commit_of(const fs::path& file) {
  const fs::path git = find_program("git");
  if (git.empty()) return {};
  const auto run = [&](std::vector<std::string> words) {
    words.insert(words.begin(), git.string());
    words.insert(words.end(), {"--", file.string()});
    return output_of({std::move(words), environment_with({}), {}, ChildProcess::Errors::discarded});
  };
  const auto changed = run({"diff", "--quiet", "HEAD"});
  if (!changed || changed->status != 0) return {};
  const auto commit = run({"log", "-1", "--format=%h"});
  return commit && commit->status == 0 ? commit->text.substr(0, commit->text.find('\n')) : "";
}

/// The controller that a channel belongs to.
std::optional<NamedController> controller_with(const std::string& channel, const Scenario& scenario) {
  for (const NamedController& known : controllers_of(scenario))
    if (channel.starts_with("/" + known.label + "/")) return known;
  return std::nullopt;
}

/// True for a library with the factory of a C++ controller. One in C or Rust has no class that could be compared.
bool is_of_cpp(const NamedController& controller, const Scenario& scenario, const HostOptions& host) {
  const auto given =
      std::ranges::find_if(host.libraries, [&](const auto& entry) { return controller.is_called(entry.first); });
  const auto file = given == host.libraries.end()
                        ? find_controller_library(controller.controller->library, folder_of(scenario))
                        : find_controller_library(given->second, fs::current_path());
  if (!file || hosted_name(*file)) return false;
  std::ifstream stream(*file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  return bytes.find("createSimpleController") != std::string::npos;
}

}  // namespace

std::string words_of_libraries(const HostOptions& host) {
  std::string words;
  for (const auto& [name, library] : host.libraries) words += fmt::format(" --controller {}={}", name, library);
  return words;
}

std::string line_of(const std::vector<std::string>& words) { return fmt::format("{}", fmt::join(words, " ")); }

std::optional<Divergence> first_differing_command(const CheckReport& report) {
  const auto& replay = report.replay;
  if (report.controller != LevelState::differs || !replay || replay->failure) return std::nullopt;
  return replay->beyond ? replay->beyond : replay->first;
}

std::vector<std::string> words_beside(const Scenario& scenario, const CheckReport& report, const fs::path& golden,
                                      const HostOptions& host) {
  const auto first = first_differing_command(report);
  if (!first) return {};
  const auto controller = controller_with(first->channel, scenario);
  if (!controller || !is_of_cpp(*controller, scenario, host) || find_program("gdb").empty()) return {};
  const std::string commit = commit_of(golden);
  if (commit.empty()) return {};
  std::vector<std::string> words{"rehearse", "replay", golden.string()};
  for (const auto& [name, library] : host.libraries)
    words.insert(words.end(), {"--controller", fmt::format("{}={}", name, library)});
  const std::string old = controllers_of(scenario).size() > 1 ? controller->label + "=" : "";
  words.insert(words.end(), {"--beside", old + commit});
  return words;
}

std::string line_advice(const Scenario& scenario, const CheckReport& report, const fs::path& golden,
                        const HostOptions& host) {
  return is_ci() ? "" : line_of(words_beside(scenario, report, golden, host));  // a clone there may have one commit
}

}  // namespace rehearse::tool
