#include <rehearse/golden.h>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <map>

#include "base/text.h"
#include "core/kinds/channel_name.h"
#include "core/trace/run_facts.h"
#include "moment.h"

namespace rehearse {
namespace {

constexpr std::size_t channels_listed = 10, remarks_listed = 3;  // with the verdict at most fifteen lines

/// The difference in multiples of its tolerance; infinite if no difference is allowed.
double times_tolerance_of(const Divergence& worst) {
  if (!(worst.tolerance > 0.0)) return std::numeric_limits<double>::infinity();
  return worst.judged() / worst.tolerance;
}

/// Worst first: channels with missing or extra messages, then by multiples of the tolerance. Equally bad channels keep
/// the order of their first difference.
bool is_worse(const ChannelComparison& a, const ChannelComparison& b) {
  const auto badness = [](const ChannelComparison& channel) {
    return channel.worst ? times_tolerance_of(*channel.worst) : std::numeric_limits<double>::infinity();
  };
  return badness(a) > badness(b);
}

std::string line_of(const ChannelComparison& channel) {
  std::string text =
      channel.group.empty() ? channel.channel : fmt::format("{}* ({} channels)", channel.group, channel.channels);
  if (channel.of_events) text += " (events)";
  const auto part = [&text](const std::string& words) { text += (text.back() == ':' ? " " : ", ") + words; };
  if (channel.worst) {
    const Divergence& worst = *channel.worst;
    const std::string element = worst.element.empty() ? "" : " " + worst.element;
    const std::string unit = worst.unit.empty() ? "" : " " + worst.unit;
    const std::string size = worst.note.empty() ? fmt::format("{:.3g}{}", worst.difference, unit)
                                                : worst.note.substr(0, worst.note.find(';'));
    text += fmt::format("{}: {} at tick {}", element, size, worst.tick);
    part(fmt::format("{} of {} values", channel.differing, channel.values));
  } else {
    text += ":";
    if (channel.of_events) part(fmt::format("{} of {}", channel.differing, channel.values));
  }
  if (channel.missing > 0) part(fmt::format("{} messages missing", channel.missing));
  if (channel.extra > 0) part(fmt::format("{} messages extra", channel.extra));
  if (!channel.worst && channel.first_bit && !channel.first_bit->note.empty() && text.back() == ':')
    part(channel.first_bit->note);
  if (text.back() == ':' && channel.first_bit) part(fmt::format("differs from tick {} on", channel.first_bit->tick));
  return text;
}

/// Text from a file, on one line.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
  return text;
}

/// The present time, or that of SOURCE_DATE_EPOCH. [s since 1970]
Result<std::time_t> present_time() {
  std::time_t now = std::time(nullptr);
  if (const char* stated = std::getenv("SOURCE_DATE_EPOCH"); stated && *stated) {
    constexpr std::int64_t year_10000 = 253402300800;
    const std::string_view text = stated;
    const auto seconds = number_in<std::int64_t>(text);
    if (!seconds || *seconds < 0 || *seconds >= year_10000)
      return error(fmt::format("SOURCE_DATE_EPOCH is '{}'", text), "it states seconds since 1970");
    now = static_cast<std::time_t>(*seconds);
  }
  return now;
}

}  // namespace

Result<std::string> date_of_today() { return fmt::format("{:%Y-%m-%d}", fmt::gmtime(REHEARSE_TRY(present_time()))); }

Result<std::string> moment_of_now() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(REHEARSE_TRY(present_time())));
}

std::vector<std::string> moved_lines(const Comparison& comparison) {
  std::vector<ChannelComparison> channels;
  for (const ChannelComparison& channel : comparison.channels) {
    // computed from other channels
    const bool follows = channel.channel == run_topics::tick || channel.channel == run_topics::transforms;
    if (!follows || channel.missing > 0 || channel.extra > 0) channels.push_back(channel);
  }
  std::ranges::stable_sort(channels, is_worse);
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < std::min(channels_listed, channels.size()); ++i) lines.push_back(line_of(channels[i]));
  if (channels.size() > channels_listed)
    lines.push_back(fmt::format("and {} channels more", channels.size() - channels_listed));
  for (std::size_t i = 0; i < std::min(remarks_listed, comparison.remarks.size()); ++i)
    lines.push_back("note: " + comparison.remarks[i]);
  return lines;
}

std::vector<Acceptance> history_of(const std::vector<mcap::Metadata>& metadata) {
  std::vector<Acceptance> history;
  for (const mcap::Metadata& record : metadata) {
    if (!record.name.starts_with(acceptance_prefix)) continue;
    Acceptance& acceptance = history.emplace_back();
    acceptance.date = one_line(stated(record.values, "date"));
    acceptance.kind = one_line(stated(record.values, "kind"));
    acceptance.accepted = one_line(stated(record.values, "accepted"));
    acceptance.verdict = one_line(stated(record.values, "verdict"));
    for (const auto& [key, value] : record.values)
      if (key.starts_with("moved.")) acceptance.moved.push_back(one_line(value));
  }
  return history;
}

std::vector<mcap::Metadata> records_of(const std::vector<Acceptance>& history) {
  std::vector<mcap::Metadata> records;
  for (const Acceptance& acceptance : history) {
    mcap::StringMap values{{"date", acceptance.date}, {"kind", acceptance.kind}};
    if (!acceptance.accepted.empty()) values["accepted"] = acceptance.accepted;
    if (!acceptance.verdict.empty()) values["verdict"] = acceptance.verdict;
    for (std::size_t i = 0; i < acceptance.moved.size(); ++i)
      values[fmt::format("moved.{:02}", i + 1)] = acceptance.moved[i];
    records.push_back({fmt::format("{}{}", acceptance_prefix, records.size() + 1), std::move(values), 0});
  }
  return records;
}

std::string acceptance_text(const Acceptance& acceptance) {
  std::string text = fmt::format("accepted {}, {}", acceptance.date, acceptance.kind);
  if (!acceptance.accepted.empty()) text += ", of it " + acceptance.accepted;
  if (!acceptance.verdict.empty()) text += ": " + acceptance.verdict;
  text += '\n';
  for (const std::string& line : acceptance.moved) text += "  " + line + '\n';
  return text;
}

std::string history_text(const std::vector<Acceptance>& history) {
  std::string text;
  for (std::size_t i = 0; i < history.size(); ++i) {
    const Acceptance& acceptance = history[i];
    text += fmt::format("  {}. {} {}", i + 1, acceptance.date, acceptance.kind);
    if (!acceptance.accepted.empty()) text += ", of it " + acceptance.accepted;
    if (!acceptance.verdict.empty()) text += ": " + acceptance.verdict;
    text += '\n';
    for (const std::string& line : acceptance.moved) text += "     " + line + '\n';
  }
  return text;
}

}  // namespace rehearse
