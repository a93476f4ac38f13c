#include "bag_doctor.h"

#include <fmt/format.h>
#include <rehearse/mcap.h>

#include <algorithm>
#include <limits>
#include <map>
#include <string>

#include "base/text.h"
#include "core/mcap/file_view.h"
#include "sqlite_bag.h"
#include "standard_types.h"

namespace rehearse {
namespace {

/// The messages of a topic.
struct Counted {
  std::string type;
  std::uint64_t messages = 0;
};

struct CountedLog {
  std::map<std::string, Counted> topics;
  std::uint64_t messages = 0;
  std::uint64_t first = std::numeric_limits<std::uint64_t>::max(), last = 0;  // log time [ns]
};

CountedLog count(mcap::Reader& log) {
  CountedLog counted;
  for (const auto& [id, channel] : log.channels()) {
    const mcap::Schema* schema = log.schema_of(channel);
    counted.topics[channel.topic].type = schema ? schema->name : "";
  }
  static_cast<void>(log.for_each_message([&](const mcap::Message& message) {
    ++counted.topics[message.channel->topic].messages;
    ++counted.messages;
    counted.first = std::min(counted.first, message.log_time);
    counted.last = std::max(counted.last, message.log_time);
    return true;
  }));
  return counted;
}

Diagnostic finding(const bag::Folder& folder, Severity severity, int line, std::string message) {
  Diagnostic diagnostic = error_in(folder.metadata.string(), std::move(message));
  diagnostic.severity = severity;
  diagnostic.line = line;
  return diagnostic;
}

void compare_topics(const bag::Folder& folder, const CountedLog& found, Diagnostics& findings) {
  for (const bag::FolderTopic& topic : folder.topics) {
    const auto there = found.topics.find(topic.name);
    const std::uint64_t messages = there == found.topics.end() ? 0 : there->second.messages;
    if (messages != topic.messages)
      findings.push_back(finding(folder, Severity::error, topic.line,
                                 fmt::format("it states {} messages on {}, but the files have {}", topic.messages,
                                             in_quotes(topic.name), messages)));
    if (there != found.topics.end() && !there->second.type.empty() && there->second.type != topic.type)
      findings.push_back(
          finding(folder, Severity::error, topic.line,
                  fmt::format("it states the type {} of {}, but the files have {}", in_quotes(topic.type),
                              in_quotes(topic.name), in_quotes(there->second.type))));
  }
  for (const auto& [name, topic] : found.topics)
    if (topic.messages > 0 && std::ranges::none_of(folder.topics, [&name = name](const bag::FolderTopic& stated) {
          return stated.name == name;
        }))
      findings.push_back(finding(folder, Severity::error, 0,
                                 fmt::format("it doesn't state the topic {}, which has {} messages in the files",
                                             in_quotes(name), topic.messages)));
}

}  // namespace

Diagnostics examine_metadata(const bag::Folder& folder, const std::filesystem::path& path) {
  const auto log = REHEARSE_TRY(mcap::Reader::open(path));
  const CountedLog found = count(*log);
  Diagnostics findings;
  if (folder.messages && static_cast<std::uint64_t>(folder.messages->value) != found.messages)
    findings.push_back(
        finding(folder, Severity::error, folder.messages->line,
                fmt::format("it states {} messages, but the files have {}", folder.messages->value, found.messages)));
  compare_topics(folder, found, findings);
  if (found.messages == 0) return findings;
  if (folder.start && static_cast<std::uint64_t>(folder.start->value) != found.first)
    findings.push_back(finding(
        folder, Severity::warning, folder.start->line,
        fmt::format("it states the start {} ns, but the first message is at {} ns", folder.start->value, found.first)));
  if (folder.duration && static_cast<std::uint64_t>(folder.duration->value) != found.last - found.first)
    findings.push_back(finding(folder, Severity::warning, folder.duration->line,
                               fmt::format("it states a duration of {} ns, but the messages span {} ns",
                                           folder.duration->value, found.last - found.first)));
  return findings;
}

std::optional<Diagnostics> examine_container(const std::filesystem::path& file) {
  const auto view = mcap::FileView::open(file);
  if (!view || !view->converted()) return std::nullopt;
  Diagnostics findings = view->converted()->damage;
  const auto bag = bag::SqliteBag::open(file, file.string());
  if (!bag) return findings;  // a compressed file: the damage states its problem
  for (const std::string& problem : (*bag)->examine())
    findings.push_back(error_in(file.string(), "SQLite reports: " + problem));
  for (const bag::Topic& topic : (*bag)->topics()) {
    if (!(*bag)->definition_of(topic.type) && !bag::standard_definition(topic.type)) {
      findings.push_back(error_in(file.string(), fmt::format("the messages on {} are of the type {}, which it doesn't "
                                                             "define: they can't be decoded",
                                                             in_quotes(topic.name), in_quotes(topic.type))));
      findings.back().severity = Severity::note;
    }
    if (topic.serialization_format == "cdr") continue;
    findings.push_back(error_in(file.string(),
                                fmt::format("the messages on {} are serialized as {}", in_quotes(topic.name),
                                            in_quotes(topic.serialization_format)),
                                "expected cdr: messages of other formats can't be decoded"));
    findings.back().severity = Severity::warning;
  }
  return findings;
}

}  // namespace rehearse
