// rehearse: the command. Verbs that simulate are in a separate program, so that this one links neither physics nor
// renderer.
#include <fmt/format.h>
#include <rehearse/logs.h>
#include <rehearse/pin.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "command.h"
#include "output.h"
#include "wings.h"

namespace rehearse::tool {
namespace {

/// Executes a different program of Rehearse, at a fixed place relative to this one. Returns only on failure.
Exit become(const char* program, char** argv) {
  const std::filesystem::path other =
      (own_program().parent_path() / PROGRAMS_BESIDE_COMMAND / program).lexically_normal();
  if (!is_pinning_off()) set_pinned_environment();
  execv(other.c_str(), argv);
  return refuse(error(fmt::format("can't start {}: {}", other.string(), std::strerror(errno)),
                      "it is built and installed together with rehearse"));
}

/// A verb with a similar name or beginning, for a hint.
std::string hint_for(std::string_view word) {
  std::vector<std::string> names;
  for (const VerbSummary& verb : all_verbs()) names.emplace_back(verb.name);
  std::string hint = spelling_hint(word, names);
  for (const std::string& name : names)
    if (hint.empty() && word.size() >= 2 && name.starts_with(word.substr(0, 2)))
      hint = fmt::format("did you mean {}? ", name);
  return hint + "rehearse --help lists all verbs";
}

/// Removes --no-pin from the arguments, at any position: it applies to the process, not to a verb.
int take_no_pin(int argc, char** argv) {
  char** const end = std::remove_if(argv + std::min(argc, 1), argv + argc,
                                    [](const char* word) { return std::string_view(word) == "--no-pin"; });
  if (end == argv + argc) return argc;
  setenv("REHEARSE_PIN", "off", 1);
  *end = nullptr;
  return static_cast<int>(end - argv);
}

Exit run(int argc, char** argv) {
  argc = take_no_pin(argc, argv);
  std::string help = "--help";
  char* help_of_verb[] = {argv[0], argc > 2 ? argv[2] : nullptr, help.data(), nullptr};
  if (argc == 3 && std::string_view(argv[1]) == "help") argv = help_of_verb;  // rehearse help VERB
  const std::string_view word = argc < 2 ? "" : argv[1];
  if (word == "--help" || word == "-h" || word == "help") {
    fmt::print("{}", overview());
    return Exit::done;
  }
  if (word == "--version") {
    fmt::print("rehearse {}\n", REHEARSE_VERSION);
    return Exit::done;
  }
  if (word.empty()) return refuse(error("no verb given", "rehearse --help lists all verbs"));
  if (is_option(word))
    return refuse(error(fmt::format("there is no option {} before the verb", plain_text(word)),
                        spelling_hint(word, {"--help", "--no-pin", "--version"}) + "see rehearse --help"));
  const VerbSummary* known = find_verb(word);
  if (!known) return refuse(error(fmt::format("there is no verb '{}'", word), hint_for(word)));
  if (!known->is_built) return refuse(left_out(fmt::format("the verb {}", word), known->wing));
  if (known->program == Program::simulate) return become("rehearse-simulate", argv);
  if (known->program == Program::audit) return become("rehearse-audit", argv);
  if (known->rounding == Rounding::matters) pin_process(argv);
  if constexpr (has_logs) read_rosbag2_logs();
  return run_own_verb("rehearse", argc, argv);
}

}  // namespace
}  // namespace rehearse::tool

int main(int argc, char** argv) { return static_cast<int>(rehearse::tool::run(argc, argv)); }
