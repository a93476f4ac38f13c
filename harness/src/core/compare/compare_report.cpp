// The findings of a comparison, in words and as a table.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "compare_structure.h"
#include "core/kinds/channel_name.h"
#include "divergence_text.h"

namespace rehearse {
namespace {

constexpr std::size_t line_width = 120;
constexpr std::size_t rows_shown = 8, remarks_shown = 3;

std::string counted(std::int64_t count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

/// False for files that are no recordings of Rehearse: their places are numbers of messages.
bool has_ticks(const Comparison& comparison) {
  const auto is_a_tick = [](const std::optional<Divergence>& d) { return d && d->channel == run_topics::tick; };
  return comparison.ticks > 0 || is_a_tick(comparison.first) || is_a_tick(comparison.first_bit);
}

std::string when_text(const Comparison& comparison, const Divergence& d) {
  if (has_ticks(comparison)) return when_text(d);
  return fmt::format("message {} ({:.16g} s)", d.tick, d.time);  // it may be the time since 1970
}

std::string place_text(const Comparison& comparison, const Divergence& d) {
  return fmt::format("{}, {}{}{}", when_text(comparison, d), d.channel, d.element.empty() ? "" : " ", d.element);
}

/// One line of the table: channels of one kind, with the same quantities.
struct Row {
  Stage stage = Stage::physics;
  std::string name;                                // of the channels: a pattern
  std::vector<const ChannelComparison*> channels;  // by their first difference
  std::int64_t count = 0;                          // of channels
  std::int64_t values = 0, differing = 0, beyond = 0;
  const ChannelComparison* worst = nullptr;
};

/// The topic with a star in place of the segment by which channels of one kind differ: "/SR1/*/wrench",
/// "/SR1/Walker/input/*/pose".
std::string pattern_of(const std::string& topic) {
  const std::string_view whose = distinguishing_segment(topic);
  if (whose.empty()) return topic;
  return std::string(topic).replace(static_cast<std::size_t>(whose.data() - topic.data()), whose.size(), "*");
}

double badness(const ChannelComparison& channel) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  if (!channel.worst) return channel.first ? infinite : -1.0;
  const double times = times_tolerance(channel.worst->judged(), channel.worst->tolerance);
  return std::isnan(times) ? infinite : times;
}

std::string name_of(const ChannelComparison& channel) {
  if (!channel.group.empty()) return channel.group + "...";
  return pattern_of(channel.channel) + (channel.of_events ? " events" : "");
}

/// One line for each pattern, in the order of the first differences.
std::vector<Row> rows_of(const Comparison& comparison) {
  std::vector<Row> rows;
  std::map<std::pair<int, std::string>, std::size_t> known;
  for (const ChannelComparison& channel : comparison.channels) {
    const std::string name = name_of(channel);
    const auto [at, is_new] = known.emplace(std::pair(static_cast<int>(channel.stage), name), rows.size());
    if (is_new) rows.emplace_back();
    Row& row = rows[at->second];
    if (row.channels.empty()) row.stage = channel.first_bit->stage;  // of /tick: the stage of the hash
    row.name = name;
    if (row.channels.empty() || row.channels.back()->channel != channel.channel) row.count += channel.channels;
    row.channels.push_back(&channel);
    row.values += channel.values;
    row.differing += channel.differing;
    row.beyond += channel.beyond;
    if (!row.worst || badness(channel) > badness(*row.worst)) row.worst = &channel;
  }
  for (Row& row : rows) {
    const ChannelComparison& first = *row.channels[0];
    if (row.count == 1) row.name = first.channel + (first.of_events ? " events" : "");
    if (row.count > 1) row.name += fmt::format(" ({})", row.count);
  }
  return rows;
}

/// The text without its middle, if it is longer than `most`. No character of UTF-8 is cut.
std::string shortened(const std::string& text, std::size_t most) {
  if (text.size() <= most) return text;
  const auto is_inside = [&text](std::size_t at) { return (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80; };
  std::size_t head = (most - 3) / 2, tail = text.size() - (most - 3 - head);
  while (head > 0 && is_inside(head)) --head;
  while (tail < text.size() && is_inside(tail)) ++tail;
  return text.substr(0, head) + "..." + text.substr(tail);
}

/// The element; for a row of several channels after the segment in place of the pattern's star.
std::string element_of(const Row& row, const Divergence& d) {
  if (row.count == 1 || row.channels.size() == 1) return d.element;
  const std::string whose(distinguishing_segment(d.channel));
  return d.element.empty() ? whose : whose + " " + d.element;
}

/// The element, then the difference and its tick. Only the element is shortened; a note is shortened as a whole.
std::string worst_text(const Row& row, std::size_t width, const char* tick) {
  constexpr std::size_t least = 12;  // characters of the element
  const ChannelComparison& channel = *row.worst;
  const Divergence& worst = channel.worst ? *channel.worst : channel.first ? *channel.first : *channel.first_bit;
  const std::string element = element_of(row, worst);
  if (!worst.note.empty())
    return shortened(fmt::format("{} {}: {}{}{}", tick, worst.tick, element, element.empty() ? "" : " ", worst.note),
                     std::max(width, 3 * least));
  const double times = times_tolerance(worst.judged(), worst.tolerance);
  const std::string unit = worst.unit.empty() ? "" : " " + worst.unit;
  std::string text = fmt::format("{:.3g}{}", worst.difference, unit);
  if (worst.distance_from_envelope)
    text += fmt::format(", {:.3g}{} beside lead and lag", *worst.distance_from_envelope, unit);
  text += fmt::format(" @{}", worst.tick);
  if (std::isfinite(times)) text += fmt::format(", {:.2g} x", times);
  return shortened(element, width > text.size() + 1 + least ? width - text.size() - 1 : least) + " " + text;
}

std::string rows_text(const std::vector<Row>& rows, const char* tick) {
  std::size_t width = 7;
  for (std::size_t i = 0; i < std::min(rows.size(), rows_shown); ++i)
    width = std::min<std::size_t>(34, std::max(width, rows[i].name.size()));
  const auto line = [&](auto stage, const std::string& name, auto first, auto values, auto differing, auto beyond,
                        const std::string& worst) {
    return fmt::format("  {:<10} {:<{}} {:>8} {:>8} {:>8} {:>8}  {}\n", stage, shortened(name, width), width, first,
                       values, differing, beyond, worst);
  };
  std::string text = line("stage", "channel", tick, "values", "differ", "beyond",
                          fmt::format("worst: difference @{}, x tolerance", tick));
  for (std::size_t i = 0; i < std::min(rows.size(), rows_shown); ++i) {
    const Row& row = rows[i];
    const std::size_t used = 2 + 10 + 1 + width + 4 * 9 + 2;
    text += line(to_string(row.stage), row.name, row.channels[0]->first_bit->tick, row.values, row.differing,
                 row.beyond, worst_text(row, line_width - used, tick));
  }
  if (rows.size() > rows_shown) {
    std::int64_t others = 0;
    for (std::size_t i = rows_shown; i < rows.size(); ++i) others += rows[i].count;
    text += fmt::format("  and {}\n", counted(others, "more channel"));
  }
  return text;
}

/// "bit-equal: 12 channels (/SR1/*/wrench, ...)"
std::string equal_text(const Comparison& comparison) {
  if (comparison.equal_channels.empty()) return "  bit-equal: nothing\n";
  std::vector<std::pair<std::string, int>> patterns;
  for (const std::string& topic : comparison.equal_channels) {
    const std::string pattern = pattern_of(topic);
    const auto known = std::ranges::find_if(patterns, [&](const auto& p) { return p.first == pattern; });
    if (known == patterns.end())
      patterns.emplace_back(pattern, 1);
    else
      ++known->second;
  }
  std::string text = fmt::format("  bit-equal: {} (", counted(std::ssize(comparison.equal_channels), "channel"));
  std::string list;
  for (const auto& [pattern, count] : patterns) {
    std::string item = pattern;
    if (count == 1)
      item = *std::ranges::find_if(comparison.equal_channels, [&, &wanted = pattern](const std::string& topic) {
        return pattern_of(topic) == wanted;
      });
    else
      item += fmt::format(" ({})", count);
    if (text.size() + list.size() + item.size() + 8 > line_width) {
      list += list.empty() ? "..." : ", ...";
      break;
    }
    list += (list.empty() ? "" : ", ") + item;
  }
  return text + list + ")\n";
}

std::string remarks_text(const std::vector<std::string>& remarks) {
  std::string text;
  for (std::size_t i = 0; i < std::min(remarks_shown, remarks.size()); ++i) text += "  note: " + remarks[i] + "\n";
  if (remarks.size() > remarks_shown)
    text +=
        fmt::format("  and {}\n", counted(std::ssize(remarks) - static_cast<std::int64_t>(remarks_shown), "more note"));
  return text;
}

std::string blanked_text(const Comparison& comparison) {
  if (comparison.blanked == 0) return "";
  return fmt::format("; {} near events that are early or late within their tolerance {} not judged",
                     counted(comparison.blanked, "value"), comparison.blanked == 1 ? "was" : "were");
}

std::string counts_text(const Comparison& comparison) {
  const std::string pictures = counted(comparison.pictures, "picture");
  if (!has_ticks(comparison))
    return fmt::format("equal bit for bit: {}, {}", counted(comparison.values - comparison.pictures, "value"),
                       pictures);
  return fmt::format("equal bit for bit: {}, {}, {}", counted(comparison.ticks, "tick"),
                     counted(comparison.values - comparison.pictures - comparison.events, "number"), pictures);
}

}  // namespace

std::optional<Divergence> worst_of_channel(const Comparison& comparison, const Divergence& of) {
  const auto channel = std::ranges::find_if(comparison.channels, [&](const ChannelComparison& compared) {
    return compared.channel == of.channel && !compared.of_events;
  });
  return channel == comparison.channels.end() ? std::nullopt : channel->worst;
}

std::string rounding_text(const Comparison& comparison) {
  const auto is_rounding = [](const ChannelComparison& channel) {
    const bool has_numbers = channel.worst && channel.worst->note.empty() && channel.first->note.empty();
    return has_numbers && channel.worst->tolerance == 0.0 && channel.worst->ulps < few_ulps &&
           std::ranges::all_of(channel.series, [](const SeriesComparison& series) {
             return series.tolerance == 0.0 || series.largest <= series.tolerance;
           });
  };
  if (comparison.within || !comparison.first || !comparison.first->note.empty()) return {};
  const Divergence* largest = nullptr;
  for (const ChannelComparison& channel : comparison.channels) {
    if (!channel.first) continue;
    if (!is_rounding(channel)) return {};
    if (!largest) largest = &*channel.worst;
  }
  if (!largest) return {};
  return fmt::format("only rounding differs: {} by {:.3g}{}{} ({}) at tick {}, and no tolerance covers it",
                     series_name(largest->channel, largest->element), largest->difference,
                     largest->unit.empty() ? "" : " ", largest->unit, few_ulps_text(largest->ulps), largest->tick);
}

std::string verdict(const Comparison& comparison) {
  if (!comparison.within) {
    if (comparison.first->channel.empty()) return "can't be compared: " + comparison.first->note;
    const std::string reason =
        comparison.explanation.empty() ? "" : "; changed since the golden: " + comparison.explanation;
    return headline_of(*comparison.first, worst_of_channel(comparison, *comparison.first),
                       {.when = when_text(comparison, *comparison.first),
                        .before_beyond = "differs: ",
                        .has_ticks = has_ticks(comparison)}) +
           reason;
  }
  if (comparison.equal) return counts_text(comparison);
  if (comparison.words_alone)
    return fmt::format("{}; the {} lines differ from tick {} on", counts_text(comparison),
                       comparison.first_bit->stage == Stage::controller ? "controllers'" : "world's",
                       comparison.first_bit->tick);
  const std::string since = fmt::format("bits differ from {} on", place_text(comparison, *comparison.first_bit));
  const std::string how = comparison.agreement == Agreement::in_noise ? "within the noise floor" : "within tolerance";
  if (!comparison.worst) return fmt::format("{}: all values are equal, but {}{}", how, since, blanked_text(comparison));
  const Divergence& worst = *comparison.worst;
  return fmt::format("{}: {} of {} values differ, the worst by {:.2g} of its tolerance ({}); {}{}", how,
                     comparison.differing, comparison.values, times_tolerance(worst.judged(), worst.tolerance),
                     place_text(comparison, worst), since, blanked_text(comparison));
}

std::string verdict(const Comparison& comparison, std::optional<double> until) {
  // a difference has its own time, which is before the horizon
  if (!until || !comparison.within) return verdict(comparison);
  return fmt::format("up to {} s {}", *until, verdict(comparison));
}

std::string table(const Comparison& comparison) {
  std::string text;
  if (!comparison.equal && !comparison.channels.empty()) {
    text += rows_text(rows_of(comparison), has_ticks(comparison) ? "tick" : "message") + equal_text(comparison);
    const auto& worst = comparison.worst;
    const bool told = comparison.first && worst && to_string(*worst) == to_string(*comparison.first);
    if (worst && !told && !comparison.within)
      text += "  worst: " + describe(*worst, when_text(comparison, *worst), has_ticks(comparison)) + "\n";
    const auto& bit = comparison.first_bit;
    const bool has_a_hash_alone = bit && bit->channel == run_topics::tick;
    if (comparison.within && bit && !has_a_hash_alone)
      text += "  first: " + describe(*bit, when_text(comparison, *bit), has_ticks(comparison)) + "\n";
    text += remarks_text(comparison.remarks);
  } else {
    std::vector<std::string> remarks = comparison.undecoded;
    if (!comparison.other_inputs.empty()) remarks.push_back(other_inputs_sentence(comparison.other_inputs));
    text += remarks_text(remarks);
  }
  for (const Diagnostic& warning : comparison.warnings) text += "  " + to_string(warning) + "\n";
  return text;
}

}  // namespace rehearse
