// rehearse golden: lists, reviews, accepts, rejects, prunes and measures goldens.
#include <fmt/format.h>

#include <cstdlib>
#include <memory>
#include <string_view>
#include <utility>

#include "golden_verbs.h"

namespace rehearse::tool {
namespace {

struct SubVerb {
  const char* name;
  const char* summary;
  DeclareGolden* declare;
};

constexpr SubVerb sub_verbs[] = {
    {"list", "all goldens: who names them, how old they are, and whether they can be used", declare_golden_list},
    {"review", "go through the runs that wait: show the changes, then accept, reject or skip", declare_golden_review},
    {"accept", "make a run that waits the golden, whole or in part, and list the changes", declare_golden_accept},
    {"reject", "remove a run that waits; the golden stays as it is", declare_golden_reject},
    {"prune", "remove the goldens that no test and no scenario names", declare_golden_prune},
    {"noise", "measure how much perturbed runs of a scenario differ without a fault", declare_golden_noise},
};

std::function<Exit()> declare_golden(CLI::App& options) {
  std::vector<std::pair<CLI::App*, std::function<Exit()>>> declared;
  for (const SubVerb& verb : sub_verbs) {
    CLI::App* sub = options.add_subcommand(verb.name, verb.summary);
    declared.emplace_back(sub, verb.declare(*sub));
  }
  options.require_subcommand(1);
  return [declared] {
    for (const auto& [sub, run] : declared)
      if (sub->parsed()) return run();
    REHEARSE_ASSERT(false, "one sub-verb is required");
    return Exit::bad_input;
  };
}

}  // namespace

Result<GoldenStore> open_store() {
  const auto folder = REHEARSE_TRY(find_golden_folder("./"));
  return GoldenStore(folder);
}

Result<void> check_may_decide() {
  const char* ci = std::getenv("CI");
  if (ci && std::string_view(ci) == "true")
    return error("goldens are only checked where CI is 'true'",
                 "accept them on a machine of yours, look at the digests, and commit them");
  return {};
}

Result<void> check_choice(const std::vector<std::string>& names, bool all) {
  if (all && !names.empty()) return error("names are given, and --all", "one of them will do");
  if (!all && names.empty())
    return error("no run is named", "NAME, or --all; rehearse golden review shows the runs that wait");
  return {};
}

extern const Verb golden_verb{"golden",
                              "  rehearse golden list\n"
                              "  rehearse golden review\n"
                              "  rehearse golden accept SR1.StandsUnderItsMinimumController\n"
                              "  rehearse golden accept SR1.Walks --channel '/SR1/LeftCamera/*'\n"
                              "  rehearse golden accept Friday.KeepsItsCommands --recording friday.mcap\n"
                              "  rehearse golden reject --all\n"
                              "  rehearse golden noise fixtures/scenarios/sr1_minimum.yaml\n",
                              declare_golden};

}  // namespace rehearse::tool
