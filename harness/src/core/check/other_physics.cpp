#include "other_physics.h"

#include <fmt/format.h>

#include "changed_files.h"
#include "core/trace/run_facts.h"

namespace rehearse {

std::string other_physics(const Scenario& scenario, const Trace& golden, const Trace& fresh,
                          const std::vector<std::string>& changed_files) {
  const std::string then = RunFacts::of(golden).stated(facts::physics),
                    now = RunFacts::of(fresh).stated(facts::physics);
  if (then.empty() || now.empty() || then == now) return {};
  const std::string files = rehearse::changed_files(scenario, golden, changed_files, true).text;
  return fmt::format("the golden's world was moved by {}, and this one by {}, so the worlds are not compared{}{}", then,
                     now, files.empty() ? "" : "; changed since the golden was recorded, too: ", files);
}

Verdict verdict_on_physics(const CheckReport& evidence, const std::string& replayed) {
  return {VerdictCode::physics_changed,
          fmt::format("physics changed: {}{}{}", evidence.other_physics, replayed.empty() ? "" : "; ", replayed)};
}

}  // namespace rehearse
