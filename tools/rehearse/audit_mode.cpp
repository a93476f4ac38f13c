#include "audit_mode.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>

#include "core/guard/child_process.h"
#include "debugger.h"

namespace rehearse::tool {

Exit continue_in_audit(std::string_view mode, const std::vector<std::filesystem::path>& recordings,
                       const CLI::App& options, const std::vector<std::string>& more) {
  const auto program = program_of_wing("audit", mode);
  if (!program) return refuse(program.errors());
  const std::vector<std::string_view> shared{
      mode, "--until", "--controller", "--call-limit", "--json", "--memory-limit", "--lcov", "--html", "--verbose"};
  std::vector<std::string> positionals;
  for (const CLI::Option* option : options.get_options()) {
    const std::string name = option->get_name();
    if (option->get_positional()) {
      positionals.push_back(name);
    } else if (option->count() > 0 && std::ranges::find(shared, name) == shared.end()) {
      return refuse(error(fmt::format("{} goes without {}", mode, name),
                          "it examines whole recordings, or with replay --until the beginning of one"));
    }
  }
  std::vector<std::string> words = words_without({positionals.begin(), positionals.end()}, "audit", options);
  words.insert(words.begin(), "rehearse");
  words.insert(words.end(), more.begin(), more.end());
  for (const std::filesystem::path& recording : recordings) words.push_back(recording.string());
  replace_process(*program, pointers_to(words).data(), {});
  return refuse(error(fmt::format("can't start {}: {}", program->string(), std::strerror(errno))));
}

void add_coverage_files(CLI::App& options, CoverageFiles& files) {
  options.add_option("--lcov", files.lcov, "with --coverage: also write a tracefile for lcov's genhtml")
      ->type_name("FILE")
      ->needs(options.get_option("--coverage"));
  options.add_option("--html", files.html, "with --coverage: also write a page for a browser, with the sources")
      ->type_name("FILE")
      ->needs(options.get_option("--coverage"));
}

}  // namespace rehearse::tool
