// The result of a replay in one sentence.
#include <fmt/format.h>
#include <rehearse/replay.h>

#include "core/compare/divergence_text.h"
#include "core/kinds/channel_name.h"

namespace rehearse {
namespace {

/// A joint's command without its topic, as far as the controller is known without it. Empty: not of a joint.
std::string name_of_command(const Divergence& command, int controllers) {
  const ChannelName name = ChannelName::parse(command.channel);
  if (name.side != ChannelSide::output || !name.owner.empty()) return {};
  return controllers > 1 ? fmt::format("{} of {}", command.element, name.label()) : command.element;
}

}  // namespace

std::string headline(const ReplayReport& replayed, const std::string& before_beyond,
                     const std::string& before_differs) {
  if (replayed.beyond)
    return headline_of(*replayed.beyond, replayed.worst,
                       {.when = when_text(*replayed.beyond),
                        .before_beyond = before_beyond,
                        .before_differs = before_differs,
                        .name = name_of_command(*replayed.beyond, replayed.controllers)});
  if (!replayed.first) return {};
  const Divergence& worst = *replayed.worst;
  const std::string name = name_of_command(worst, replayed.controllers);
  return fmt::format(
      "only bits differ, from {} on; all commands are within tolerance: the worst is {}, off by "
      "{:.3g}{}{} of ±{:g} at tick {}",
      when_text(*replayed.first), name.empty() ? series_name(worst.channel, worst.element) : name, worst.judged(),
      worst.unit.empty() ? "" : " ", worst.unit, worst.tolerance, worst.tick);
}

}  // namespace rehearse
