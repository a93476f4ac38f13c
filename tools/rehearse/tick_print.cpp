#include "tick_print.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/compare/divergence_text.h"
#include "core/kinds/channel_name.h"

namespace rehearse::tool {
namespace {

constexpr std::size_t most_rows = 12;  // of a channel without joints

std::string number_text(double value) { return std::isnan(value) ? "NaN" : fmt::format("{:.7g}", value); }

std::string delta_text(const ViewValue& value) {
  return value.changed() ? fmt::format("{:+.3g}", value.value - *value.before) : "";
}

std::string ulps_text(std::uint64_t ulps) {
  if (ulps == std::numeric_limits<std::uint64_t>::max()) return "";
  return ulps < 1000000 ? fmt::format("{}", ulps) : fmt::format("{:.2g}", static_cast<double>(ulps));
}

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

bool is_shown(const ViewValue& value, const TickParts& parts) {
  return parts.only.empty() || has(parts.only, value.series);
}

/// True if the value needs a row even without `full`.
bool is_news(const ViewValue& value, const TickParts& parts) {
  return parts.full || !parts.only.empty() || value.changed() || value.replayed || !value.before;
}

std::string folded(std::size_t count, std::string_view what) {
  return count == 0 ? "" : fmt::format("    ({} {}{})\n", count, what, count == 1 ? "" : "s");
}

std::string heading(const ViewChannel& channel) {
  return channel.owner.empty() || channel.kind == ViewChannel::Kind::other ? channel.topic : channel.part;
}

/// One joint's values by quantity.
struct JointRow {
  std::string joint;
  std::vector<const ViewValue*> values;  // in the order of the table's quantities; null: none
};

struct JointTable {
  std::vector<std::string> quantities;  // q, dq, u
  std::vector<std::string> units;
  std::vector<JointRow> rows;
};

/// Adds a channel's joints; `side`: prefix of its quantities, as "in ".
void add_joints(JointTable& table, const ViewChannel& channel, const std::string& side, const TickParts& parts) {
  for (const ViewValue& value : channel.values) {
    if (!is_shown(value, parts)) continue;
    const std::size_t slash = value.element.rfind('/');
    const std::string joint = value.element.substr(0, slash);
    const std::string quantity = side + (slash == std::string::npos ? "" : value.element.substr(slash + 1));
    auto column = std::ranges::find(table.quantities, quantity);
    if (column == table.quantities.end()) {
      table.quantities.push_back(quantity);
      table.units.push_back(value.unit);
      column = table.quantities.end() - 1;
    }
    const auto index = static_cast<std::size_t>(column - table.quantities.begin());
    std::string& unit = table.units[index];
    if (unit.find(value.unit) == std::string::npos) unit += " or " + value.unit;
    auto row = std::ranges::find_if(table.rows, [&](const JointRow& r) { return r.joint == joint; });
    if (row == table.rows.end()) row = table.rows.insert(table.rows.end(), {joint, {}});
    if (row->values.size() <= index) row->values.resize(index + 1, nullptr);
    row->values[index] = &value;
  }
}

bool any_replayed(const ViewChannel& channel, const TickParts& parts) {
  return std::ranges::any_of(channel.values,
                             [&](const ViewValue& value) { return is_shown(value, parts) && value.replayed; });
}

void add_cells(TableRow& cells, const ViewValue* value, bool with_replay) {
  cells.push_back(value ? number_text(value->value) : "");
  cells.push_back(value ? delta_text(*value) : "");
  if (!with_replay) return;
  const bool differs = value && value->replayed;
  cells.push_back(differs ? number_text(*value->replayed) : "");
  cells.push_back(differs ? fmt::format("{:+.3g}", *value->replayed - value->value) : "");
  cells.push_back(differs ? ulps_text(value->ulps) : "");
}

void add_titles(TableRow& titles, const std::string& quantity, const std::string& unit, bool with_replay) {
  titles.push_back(unit.empty() ? quantity : fmt::format("{} [{}]", quantity, unit));
  titles.push_back("Δ tick");
  if (!with_replay) return;
  titles.push_back("replayed");
  titles.push_back("≠");
  titles.push_back("ULPs");
}

/// Prints a controller's joint inputs and commands side by side; `commands` may be null.
std::string joints_text(const ViewChannel& channel, const ViewChannel* commands, const TickParts& parts) {
  JointTable table;
  add_joints(table, channel, commands ? "in " : "", parts);
  const std::size_t inputs = table.quantities.size();
  if (commands) add_joints(table, *commands, "out ", parts);
  if (table.rows.empty()) return "";
  std::vector<TableRow> rows(1, {heading(channel)});
  const bool differs = any_replayed(commands ? *commands : channel, parts);
  const auto has_replay = [&](std::size_t quantity) { return differs && (!commands || quantity >= inputs); };
  for (std::size_t i = 0; i < table.quantities.size(); ++i)
    add_titles(rows[0], table.quantities[i], table.units[i], has_replay(i));
  std::size_t unchanged = 0;
  for (JointRow& joint : table.rows) {
    joint.values.resize(table.quantities.size(), nullptr);
    const bool is_told =
        std::ranges::any_of(joint.values, [&](const ViewValue* value) { return value && is_news(*value, parts); });
    if (!is_told) {
      ++unchanged;
      continue;
    }
    TableRow& row = rows.emplace_back(1, "  " + plain_text(joint.joint));
    for (std::size_t i = 0; i < joint.values.size(); ++i) add_cells(row, joint.values[i], has_replay(i));
  }
  return table_text(rows, "  ") + folded(unchanged, "unchanged joint");
}

std::string values_text(const ViewChannel& channel, const TickParts& parts) {
  const bool replayed = any_replayed(channel, parts);
  std::vector<TableRow> rows(1, {plain_text(heading(channel))});
  add_titles(rows[0], "", "", replayed);
  rows[0].push_back("");
  std::size_t unchanged = 0, more = 0, shown = 0;
  for (const ViewValue& value : channel.values) {
    if (!is_shown(value, parts)) continue;
    ++shown;
    if (!is_news(value, parts)) {
      ++unchanged;
    } else if (!parts.full && parts.only.empty() && rows.size() > most_rows && !value.replayed) {
      ++more;
    } else {
      TableRow& row = rows.emplace_back(1, "  " + plain_text(value.element));
      add_cells(row, &value, replayed);
      row.push_back(value.unit == "quaternion" ? "" : value.unit);
    }
  }
  if (shown == 0) return "";
  if (rows.size() == 1) return fmt::format("  {}: {} unchanged\n", rows[0][0], count_text(unchanged, "number"));
  return table_text(rows, "  ") + folded(unchanged, "unchanged number") +
         folded(more, "more changed number, --full shows them; number");
}

std::string title_of(const ViewChannel& channel) {
  switch (channel.kind) {
    case ViewChannel::Kind::input: return channel.owner + " reads";
    case ViewChannel::Kind::output: return channel.owner + " commands";
    case ViewChannel::Kind::state: return channel.owner + ", state";
    case ViewChannel::Kind::sensor: return channel.owner + ", sensors";
    case ViewChannel::Kind::other: return channel.owner.empty() ? "others" : channel.owner + ", its own";
  }
  return "";
}

bool is_asked_for(const ViewChannel& channel, const TickParts& parts) {
  switch (channel.kind) {
    case ViewChannel::Kind::input: return parts.inputs;
    case ViewChannel::Kind::output: return parts.outputs;
    default: return parts.rest;
  }
}

/// Controllers first, each with its inputs and commands; then bodies, with state and sensors.
std::vector<const ViewChannel*> in_order(const TickView& view, const TickParts& parts) {
  std::vector<const ViewChannel*> channels;
  for (const ViewChannel& channel : view.channels)
    if (is_asked_for(channel, parts)) channels.push_back(&channel);
  const auto key = [](const ViewChannel* channel) {
    const bool of_controller = channel->kind == ViewChannel::Kind::input || channel->kind == ViewChannel::Kind::output;
    return std::tuple(!of_controller, channel->owner.empty(), std::string_view(channel->owner), channel->kind);
  };
  std::ranges::stable_sort(channels, [&](const ViewChannel* a, const ViewChannel* b) { return key(a) < key(b); });
  return channels;
}

/// The commands for the joints that a controller reads in that channel; null: none.
const ViewChannel* commands_beside(const ViewChannel& channel, const std::vector<const ViewChannel*>& channels) {
  if (!channel.is_joints || channel.kind != ViewChannel::Kind::input) return nullptr;
  for (const ViewChannel* other : channels)
    if (other->is_joints && other->kind == ViewChannel::Kind::output && other->owner == channel.owner) return other;
  return nullptr;
}

Json json_of(const ViewValue& value) {
  Json object{{"series", value.series},
              {"element", value.element},
              {"unit", value.unit},
              {"value", number_json(value.value)},
              {"changed", value.changed()}};
  object["delta"] = value.before ? number_json(value.value - *value.before) : Json(nullptr);
  object["replayed"] = value.replayed ? number_json(*value.replayed) : Json(nullptr);
  if (value.replayed) object["ulps"] = value.ulps;
  return object;
}

constexpr const char* kind_names[] = {"input", "output", "state", "sensor", "other"};  // by ViewChannel::Kind
constexpr const char* where_names[] = {"both", "recorded", "replayed"};                // by ViewMessage::Where

}  // namespace

std::string tick_text(std::int64_t tick, double time) { return fmt::format("tick {}, {:.10g} s", tick, time); }

std::string table_text(const std::vector<TableRow>& rows, std::string_view indent) {
  std::vector<std::size_t> widths;
  for (const TableRow& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (widths.size() <= i) widths.push_back(0);
      widths[i] = std::max(widths[i], width_of(row[i]));
    }
  std::string text;
  for (const TableRow& row : rows) {
    std::string line(indent);
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (widths[i] == 0) continue;
      const std::string blanks(widths[i] - width_of(row[i]), ' ');
      const bool is_last_text = i + 1 == row.size() && i > 1;
      line += i == 0 || is_last_text ? (i == 0 ? "" : "  ") + row[i] + blanks : "  " + blanks + row[i];
    }
    while (line.ends_with(' ')) line.pop_back();
    text += line + "\n";
  }
  return text;
}

std::string message_text(const ViewMessage& message) {
  const std::string_view where = message.where == ViewMessage::Where::recorded   ? " (in the recording only)"
                                 : message.where == ViewMessage::Where::replayed ? " (in the replay only)"
                                                                                 : "";
  const std::string kind = message.severity == "note" ? "" : message.severity + ": ";
  return fmt::format("{}: {}{}{}", plain_text(message.source), kind, plain_text(message.text), where);
}

std::string contact_text(const ViewContact& contact) {
  return fmt::format("{} {} {}", plain_text(contact.link),
                     contact.began     ? "begins to touch"
                     : contact.touches ? "touches"
                                       : "no longer touches",
                     plain_text(contact.other));
}

std::string difference_text(const Divergence& difference) {
  const std::string place =
      difference.element.empty() ? difference.channel : series_name(difference.channel, difference.element);
  if (!difference.note.empty()) return fmt::format("{}: {}", plain_text(place), difference.note);
  const std::string unit = difference.unit.empty() ? "" : " " + difference.unit;
  const std::string ulps = few_ulps_text(difference.ulps);
  return fmt::format("{}: replayed {}{}, recorded {} (difference {:+.3g}{})", plain_text(place), difference.actual,
                     unit, difference.expected, difference.actual - difference.expected,
                     ulps.empty() ? "" : ", " + ulps);
}

std::string text_of(const TickView& view, const TickParts& parts) {
  std::string text = tick_text(view.tick, view.time) + "\n", title;
  const std::vector<const ViewChannel*> channels = in_order(view, parts);
  std::vector<const ViewChannel*> done;
  for (const ViewChannel* channel : channels) {
    if (std::ranges::find(done, channel) != done.end()) continue;
    const ViewChannel* commands = commands_beside(*channel, channels);
    if (commands) done.push_back(commands);
    const std::string part = channel->is_joints ? joints_text(*channel, commands, parts) : values_text(*channel, parts);
    if (part.empty()) continue;
    const std::string its_title = commands ? channel->owner + " reads and commands" : title_of(*channel);
    if (title != its_title) text += plain_text(title = its_title) + "\n";
    text += part;
  }
  if (!parts.only.empty()) return text;
  const auto add = [&text](std::string_view heading, const std::vector<std::string>& lines) {
    if (lines.empty()) return;
    text += fmt::format("{}\n", heading);
    for (const std::string& line : lines) text += "  " + line + "\n";
  };
  std::vector<std::string> lines;
  if (parts.rest)
    for (const ViewPicture& picture : view.pictures)
      lines.push_back(fmt::format("{}, {}", plain_text(picture.topic), file_size_text(picture.bytes)));
  add("pictures that arrived", lines);
  lines.clear();
  if (parts.contacts)
    for (const ViewContact& contact : view.contacts) lines.push_back(contact_text(contact));
  add("contacts", lines);
  lines.clear();
  if (parts.threads)
    for (const std::string& thread : view.threads) lines.push_back(plain_text(thread));
  add("threads", lines);
  lines.clear();
  if (parts.messages)
    for (const ViewMessage& message : view.messages) lines.push_back(message_text(message));
  add("messages", lines);
  lines.clear();
  if (parts.differences) {
    for (const Divergence& difference : view.differences) lines.push_back(difference_text(difference));
    if (view.differences.empty())
      text += view.is_replayed ? "the replay gives the same bits as the recording\n"
                               : "not replayed: commands are those of the recording\n";
  }
  add("differs from the recording", lines);
  return text;
}

Json json_of(const TickView& view, const TickParts& parts) {
  Json channels = Json::array(), messages = Json::array(), contacts = Json::array(), pictures = Json::array(),
       differences = Json::array();
  for (const ViewChannel& channel : view.channels) {
    Json values = Json::array();
    for (const ViewValue& value : channel.values)
      if (is_shown(value, parts)) values.push_back(json_of(value));
    if (!values.empty())
      channels.push_back({{"topic", channel.topic},
                          {"owner", channel.owner},
                          {"kind", kind_names[static_cast<std::size_t>(channel.kind)]},
                          {"values", values}});
  }
  for (const ViewMessage& message : view.messages)
    messages.push_back({{"source", message.source},
                        {"severity", message.severity},
                        {"text", message.text},
                        {"in", where_names[static_cast<std::size_t>(message.where)]}});
  for (const ViewContact& contact : view.contacts)
    contacts.push_back({{"link", contact.link},
                        {"other", contact.other},
                        {"touches", contact.touches},
                        {"changed", contact.began || !contact.touches}});
  for (const ViewPicture& picture : view.pictures)
    pictures.push_back({{"topic", picture.topic}, {"bytes", picture.bytes}});
  for (const Divergence& difference : view.differences) differences.push_back(rehearse::json_of(difference));
  return {{"tick", view.tick},    {"time", view.time},       {"replayed", view.is_replayed},
          {"channels", channels}, {"messages", messages},    {"contacts", contacts},
          {"pictures", pictures}, {"threads", view.threads}, {"differences", differences}};
}

}  // namespace rehearse::tool
