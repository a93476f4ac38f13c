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
  const Divergence& worst = *replayed.largest;
  const std::string name = name_of_command(worst, replayed.controllers);
  const std::string unit = worst.unit.empty() ? "" : " " + worst.unit;
  const bool is_rounding = replayed.most_ulps < few_ulps;
  return fmt::format(
      "{}{} from {} on: worst {}, off by {:.3g}{}{} at tick {}", before_beyond,
      is_rounding ? fmt::format("only bits differ, by up to {},", few_ulps_text(replayed.most_ulps))
                  : "commands change within tolerance",
      when_text(*replayed.first), name.empty() ? series_name(worst.channel, worst.element) : name, worst.difference,
      unit,
      worst.distance_from_envelope ? " and within lead and lag" : fmt::format(" of ±{:g}{}", worst.tolerance, unit),
      worst.tick);
}

}  // namespace rehearse
