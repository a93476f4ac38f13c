// rehearse-read: the verbs that need neither physics nor renderer, and all that names no verb. Only `rehearse` starts
// it.
#include <fmt/format.h>
#include <rehearse/pin.h>

#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "command.h"
#include "log_library.h"
#include "new_project.h"
#include "output.h"

namespace rehearse::tool {
namespace {

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

Exit run(int argc, char** argv) {
  const std::string_view word = argc < 2 ? "" : argv[1];
  if (word == "--help" || word == "-h" || word == "help") {
    std::fputs(overview().c_str(), stdout);
    return after_output(Exit::done);
  }
  if (word == "--version") {
    const std::string_view commit = built_from().commit;
    fmt::print("rehearse {}{}{}\n", REHEARSE_VERSION, commit.empty() ? "" : ", commit ", commit);
    return after_output(Exit::done);
  }
  if (word.empty()) return refuse(error("no verb given", "rehearse --help lists all verbs"));
  if (is_option(word))
    return refuse(error(fmt::format("there is no option {} before the verb", plain_text(word)),
                        spelling_hint(word, {"--help", "--no-pin", "--version"}) + "see rehearse --help"));
  const VerbSummary* known = find_verb(word);
  if (!known) return refuse(error(fmt::format("there is no verb '{}'", word), hint_for(word)));
  if (!known->wing_adds && !is_in_this_build(known->wing))
    return refuse(left_out(fmt::format("the verb {}", word), known->wing));
  if (known->rounding == Rounding::matters) pin_process(argv);
  open_logs_when_needed();
  return run_own_verb(argc, argv);
}

}  // namespace
}  // namespace rehearse::tool

int main(int argc, char** argv) { return static_cast<int>(rehearse::tool::run(argc, argv)); }
