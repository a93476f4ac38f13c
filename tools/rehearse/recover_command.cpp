// rehearse recover: writes a complete file with the readable messages of a cut or damaged file.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "command.h"
#include "core/mcap/recover.h"
#include "options.h"
#include "output.h"
#include "output_file.h"

namespace rehearse::tool {
namespace {

constexpr std::size_t losses_shown = 20;  // for people; JSON contains more

struct RecoverSettings {
  std::string source;
  std::string target;
  mcap::RecoverOptions options;
  bool json = false;
};

void tell_losses(const mcap::Recovery& recovery) {
  for (std::size_t i = 0; i < std::min(losses_shown, recovery.lost.size()); ++i) {
    const mcap::LostBytes& lost = recovery.lost[i];
    fmt::print("  bytes {} to {}, {}: {}\n", lost.begin, lost.end, file_size_text(lost.end - lost.begin), lost.what);
  }
  if (recovery.lost.size() > losses_shown)
    fmt::print("  and {} more places; --json lists them\n", recovery.lost.size() - losses_shown);
  for (const std::string& remark : recovery.remarks) fmt::print("  {}\n", remark);
}

/// The missing messages by channel.
void tell_lost_messages(const mcap::Recovery& recovery) {
  if (recovery.lost_messages == 0) {
    if (!recovery.loss_is_known)
      fmt::print("the number of lost messages is unknown{}\n",
                 recovery.lost_bytes > 0 ? ": the file's statistics are lost, too" : "");
    return;
  }
  // A database states their number alone.
  const bool by_channel =
      std::ranges::any_of(recovery.channels, [](const auto& entry) { return entry.second.lost > 0; });
  fmt::print("{} lost{}{}\n", count_text(recovery.lost_messages, "message"),
             recovery.loss_is_known ? "" : ", or more (the file's statistics are lost, too)", by_channel ? ":" : "");
  for (const auto& [id, channel] : recovery.channels)
    if (channel.lost > 0)
      fmt::print("  {}: {} of {}\n", channel.topic.empty() ? fmt::format("channel {}", id) : channel.topic,
                 channel.lost, channel.saved + channel.lost);
}

void tell(const RecoverSettings& settings, const mcap::Recovery& recovery) {
  if (recovery.is_whole()) fmt::print("{} is whole: nothing is lost\n", settings.source);
  fmt::print("saved {}, {}, {} in {}\n", count_text(recovery.messages, "message"),
             count_text(recovery.attachments, "attachment"), count_text(recovery.metadata, "metadata record"),
             settings.target);
  if (recovery.messages > 0)
    fmt::print("from {} to {}{}\n", time_text(recovery.first_time), time_text(recovery.last_time),
               recovery.source_last_time && *recovery.source_last_time > recovery.last_time
                   ? fmt::format("; the messages after that, up to {}, are lost", time_text(*recovery.source_last_time))
                   : "");
  if (recovery.is_whole()) return;
  if (recovery.lost_bytes > 0)
    fmt::print("{} of {} aren't in it\n", file_size_text(recovery.lost_bytes), file_size_text(recovery.size));
  tell_losses(recovery);
  tell_lost_messages(recovery);
}

Json result_json(const RecoverSettings& settings, const mcap::Recovery& recovery) {
  Json lost = Json::array(), channels = Json::array();
  for (const mcap::LostBytes& span : recovery.lost)
    lost.push_back({{"begin", span.begin}, {"end", span.end}, {"what", span.what}});
  for (const auto& [id, channel] : recovery.channels)
    channels.push_back({{"id", id}, {"topic", channel.topic}, {"saved", channel.saved}, {"lost", channel.lost}});
  return {{"file", settings.target},
          {"whole", recovery.is_whole()},
          {"messages", recovery.messages},
          {"attachments", recovery.attachments},
          {"metadata", recovery.metadata},
          {"first_time", recovery.first_time},
          {"last_time", recovery.last_time},
          {"lost_messages", recovery.lost_messages},
          {"loss_is_known", recovery.loss_is_known},
          {"lost_bytes", recovery.lost_bytes},
          {"lost", lost},
          {"remarks", recovery.remarks},
          {"channels", channels}};
}

Exit run_recover(RecoverSettings& settings) {
  return write_trace(settings, "recovering", [&](const std::filesystem::path& trace) {
    return mcap::recover(settings.source, trace, settings.options);
  });
}

std::function<Exit()> declare_recover(CLI::App& options) {
  const auto settings = std::make_shared<RecoverSettings>();
  options.add_option("TRACE", settings->source, "a recording, or any other MCAP file or ROS 2 bag")
      ->required()
      ->type_name("");
  options.add_option("-o,--output", settings->target, "the file to write; - is stdout")->required()->type_name("FILE");
  options.add_flag("--trust-damaged", settings->options.trust_damaged,
                   "keep the readable messages of chunks whose CRC doesn't match, although they may be wrong");
  add_json_flag(options, settings->json);
  return [settings] { return run_recover(*settings); };
}

}  // namespace

extern const Verb recover_verb{
    "recover",
    "  rehearse recover killed.mcap -o saved.mcap\n"
    "  rehearse recover damaged.mcap -o saved.mcap --json\n"
    "\n"
    "Exit status: 0 FILE is written, and is a valid file (it was opened again and examined), even if\n"
    "something is lost; the losses are listed. 2 there was nothing to be saved; nothing was written.\n",
    declare_recover};

}  // namespace rehearse::tool
