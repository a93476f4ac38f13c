#include "recorded_delays.h"

#include <algorithm>
#include <utility>

#include "core/kinds/channel_name.h"

namespace rehearse {

RecordedDelays::RecordedDelays(const ControllerHost& host, const mcap::Reader& recording) {
  for (const HostedController& hosted : host.controllers()) {
    Commands commands{&hosted};
    for (const auto& [id, channel] : recording.channels()) {
      const ChannelName name = ChannelName::parse(channel.topic);
      if (!name.is_of(hosted.label, ChannelSide::output) || name.kind == ChannelKind::device_state) continue;
      const auto stated = channel.metadata.find("delay");
      if (name.kind == ChannelKind::delay) {
        commands.channel = id;
        channels_.push_back(id);
      } else if (commands.topic.empty() && stated != channel.metadata.end()) {
        commands.topic = channel.topic;
        commands.delayed = stated->second == "true";
      }
    }
    if (!commands.topic.empty()) all_.push_back(std::move(commands));
  }
}

void RecordedDelays::accept(const mcap::Message& message) {
  for (Commands& commands : all_)
    if (commands.channel == message.channel->id) commands.is_other_mode = true;
}

void RecordedDelays::compare(const OnDifference& differs) {
  for (Commands& commands : all_) {
    const bool recorded = commands.delayed != std::exchange(commands.is_other_mode, false);
    const bool now = commands.hosted->tick.delayed;
    const bool known = std::exchange(commands.differs, commands.hosted->running && now != recorded);
    if (known || !commands.differs) continue;
    Divergence found;
    found.channel = commands.topic;
    found.stage = Stage::controller;
    found.note = now ? "its commands act one tick later than the recorded ones: it has left the no-delay mode"
                     : "its commands act one tick earlier than the recorded ones: it has entered the no-delay mode";
    differs(std::move(found));
  }
}

}  // namespace rehearse
