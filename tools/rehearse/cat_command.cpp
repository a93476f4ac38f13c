// rehearse cat: prints the messages of a trace, or of any MCAP file, one per line.
#include <fmt/format.h>

#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "command.h"
#include "core/guard/result_stream.h"
#include "core/trace/message_print.h"
#include "core/trace/select.h"
#include "options.h"
#include "output.h"
#include "progress.h"

namespace rehearse::tool {
namespace {

struct CatSettings {
  std::string trace;
  mcap::Selection selection;
  std::uint64_t limit = std::numeric_limits<std::uint64_t>::max();  // messages
  bool json = false;
};

/// Prints lines on stdout and counts them.
class Lines {
 public:
  explicit Lines(const CatSettings& settings)
      : limit_(settings.limit), printer_(settings.json ? MessagePrinter::Form::json : MessagePrinter::Form::line) {}

  /// Returns false if no more lines are needed: the limit is reached, or stdout takes none.
  bool print(const mcap::Message& message, const mcap::Schema* schema) {
    const std::string_view line = printer_.print(message, schema);
    if (std::fwrite(line.data(), 1, line.size(), result_stream()) != line.size()) return false;
    return ++printed_ < limit_;
  }

  std::uint64_t printed() const { return printed_; }

 private:
  const std::uint64_t limit_;
  MessagePrinter printer_;
  std::uint64_t printed_ = 0;
};

Exit run_cat(const CatSettings& settings) {
  const auto opened = mcap::Reader::open(settings.trace);
  if (!opened) return refuse(opened.errors());
  mcap::Reader& reader = **opened;
  auto selector = mcap::Selector::of(settings.selection, reader);
  if (!selector) return refuse(selector.errors());
  std::vector<std::uint16_t> channels;
  for (const auto& [id, channel] : reader.channels())
    if (selector->takes_topic(channel.topic)) channels.push_back(id);
  const std::int64_t all = reader.statistics() ? static_cast<std::int64_t>(reader.statistics()->message_count) : 0;
  Lines lines(settings);
  std::optional<Progress> progress;
  if (!is_terminal(result_stream())) progress.emplace("printing");
  std::int64_t passed = 0;
  const Result<void> read = reader.for_each_message_in_order(
      [&](const mcap::Message& message) {
        if (progress) progress->show(++passed, all);
        if (selector->end() && message.log_time >= *selector->end()) return false;
        return !selector->takes(message) || lines.print(message, reader.schema_of(*message.channel));
      },
      channels);
  progress.reset();
  if (read && lines.printed() == 0 && !std::ferror(result_stream()))
    if (const auto refused = selector->refusal_of_empty(reader)) return refuse(*refused);
  return read ? Exit::done : refuse(read.errors());
}

std::function<Exit()> declare_cat(CLI::App& options) {
  const auto settings = std::make_shared<CatSettings>();
  options
      .add_option(
          "TRACE", settings->trace,
          "a recording, or any other log: MCAP, a rosbag2 folder or database, a bag of ROS 1; - is standard input")
      ->required()
      ->type_name("");
  add_selection_options(options, settings->selection);
  add_integer(options, "--limit", "stop after so many messages", 1, std::numeric_limits<std::int64_t>::max(),
              [=](std::int64_t limit) { settings->limit = static_cast<std::uint64_t>(limit); });
  options.add_flag("--json", settings->json,
                   "print one JSON object a line: topic, log_time, publish_time [ns], sequence, and message, or, if it "
                   "can't be decoded, data. Bytes (uint8[]) and data are base64");
  return [settings] { return run_cat(*settings); };
}

}  // namespace

extern const Verb cat_verb{"cat",
                           "  rehearse cat sr1.mcap --topics /tick --limit 3\n"
                           "  rehearse cat bag.mcap --topics '/imu*' --from +2 --until +2.5 --json\n"
                           "  zstd -dc bag.mcap.zst | rehearse cat - | less\n",
                           declare_cat};

}  // namespace rehearse::tool
