#include <fmt/format.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "base/replaceable.h"
#include "channel_table.h"
#include "export_files.h"
#include "export_source.h"
#include "trace_export.h"

namespace rehearse {
namespace {

std::string heading(const std::vector<ChannelTable::Column>& columns) {
  std::string line(table_magic);
  for (const ChannelTable::Column& column : columns) {
    line += ',';
    append_cell(line, column.unit.empty() ? column.name : fmt::format("{} [{}]", column.name, column.unit));
  }
  return line + '\n';
}

void note_left_out(const std::string& topic, const ChannelTable& table, ExportReport& report) {
  const std::set<std::string> fields = table.left_out();
  if (!fields.empty()) report.left_out.push_back({topic, {fields.begin(), fields.end()}});
}

/// The output of a topic.
struct Output {
  std::unique_ptr<ChannelTable> table;
  ExportedTopic topic;
};
using Outputs = std::map<std::uint16_t, Output>;  // by channel

/// The tables of all channels that can have one, with all their columns, which a first pass finds.
Result<Outputs> learn_columns(ExportSource& source, bool bytes, ExportReport& report) {
  Outputs outputs;
  for (const mcap::Channel* channel : source.channels()) {
    auto table = ChannelTable::make(*channel, source.schema_of(*channel), bytes);
    if (table) {
      outputs[channel->id].table = std::move(*table);
      outputs[channel->id].topic.topic = channel->topic;
    } else {
      report.skipped.push_back({channel->topic, table.errors().front().message});
    }
  }
  REHEARSE_TRY(source.pass([&](const mcap::Message& message) -> Result<void> {
    const auto output = outputs.find(message.channel->id);
    if (output == outputs.end()) return {};
    if (output->second.table->read(message.data)) {
      ++output->second.topic.rows;
    } else {
      source.note(*message.channel,
                  fmt::format("the message at {} ns doesn't fit its schema, or has too many values", message.log_time));
    }
    return {};
  }));
  for (auto output = outputs.begin(); output != outputs.end();) {
    if (output->second.topic.rows > 0) {
      ++output;
      continue;
    }
    report.skipped.push_back({output->second.topic.topic, "no messages"});
    output = outputs.erase(output);
  }
  return outputs;
}

/// A table of all series, with one row per tick, or per message of another topic.
class JoinedTable {
 public:
  static Result<JoinedTable> learn(ExportSource& source, const std::string& clock, ExportReport& report);

  std::string heading_line() const;
  std::int64_t columns() const;
  /// Reads a message. If it is the first message of a new time, or another one of the clock, the row before is
  /// complete; if that row is the clock's, it is written to `line`.
  void take(const mcap::Message& message, std::string& line);
  /// Writes the present row to `line`.
  void end_row(std::string& line);
  bool has_rows() const { return has_rows_; }
  void note_all_left_out(ExportReport& report) const {
    for (const Part& part : parts_) note_left_out(part.table->channel().topic, *part.table, report);
  }

 private:
  struct Part {
    std::unique_ptr<SeriesTable> table;
    std::size_t columns = 0;
    bool is_clock = false;
    bool is_there = false;  // the present row has a message of the channel
  };

  std::vector<Part> parts_;
  std::map<std::uint16_t, std::size_t> by_channel_;
  std::optional<std::uint64_t> time_;  // time of the present row [ns]
  bool has_rows_ = false;
  bool holds_ = false;  // series keep their values until their next message
};

Result<JoinedTable> JoinedTable::learn(ExportSource& source, const std::string& clock, ExportReport& report) {
  JoinedTable joined;
  joined.holds_ = !clock.empty();
  for (const mcap::Channel* channel : source.channels()) {
    auto table = SeriesTable::make(*channel, source.schema_of(*channel), true);
    if (!table) {
      report.skipped.push_back({channel->topic, table.errors().front().message});
    } else if (*table == nullptr) {
      report.skipped.push_back({channel->topic, "its messages are no series of numbers"});
    } else {
      const bool is_clock = clock.empty() ? (*table)->channel().type == msg::Tick::type_name : channel->topic == clock;
      joined.by_channel_[channel->id] = joined.parts_.size();
      joined.parts_.push_back({std::move(*table), 0, is_clock, false});
    }
  }
  const bool has_clock = std::ranges::any_of(joined.parts_, [](const Part& part) { return part.is_clock; });
  if (clock.empty() && !has_clock && source.has_ticks())  // its messages have the times of ticks
    for (Part& part : joined.parts_) part.is_clock = true;
  REHEARSE_TRY(source.pass([&](const mcap::Message& message) -> Result<void> {
    const auto part = joined.by_channel_.find(message.channel->id);
    if (part == joined.by_channel_.end()) return {};
    if (!joined.parts_[part->second].table->read(message.data)) {
      source.note(*message.channel,
                  fmt::format("the message at {} ns doesn't fit its schema, or has too many values", message.log_time));
    } else if (joined.parts_[part->second].is_clock) {
      joined.has_rows_ = true;
    }
    return {};
  }));
  std::vector<TraceChannel*> channels;
  for (Part& part : joined.parts_) {
    part.columns = part.table->channel().columns.size();
    channels.push_back(&part.table->channel());
  }
  std::map<std::string, SeriesPlace, std::less<>> series;
  name_series(channels, series);
  return joined;
}

std::string JoinedTable::heading_line() const {
  std::vector<ChannelTable::Column> all;
  for (const Part& part : parts_) {
    const auto columns = part.table->columns();
    all.insert(all.end(), columns.begin(), columns.end());
  }
  return heading(all);
}

std::int64_t JoinedTable::columns() const {
  std::int64_t count = 1;
  for (const Part& part : parts_) count += static_cast<std::int64_t>(part.columns);
  return count;
}

void JoinedTable::take(const mcap::Message& message, std::string& line) {
  const auto place = by_channel_.find(message.channel->id);
  if (place == by_channel_.end()) return;
  Part& part = parts_[place->second];
  if (time_ != message.log_time || (part.is_clock && part.is_there)) end_row(line);
  time_ = message.log_time;
  part.is_there = part.table->read(message.data);
}

void JoinedTable::end_row(std::string& line) {
  const bool is_row = std::ranges::any_of(parts_, [](const Part& p) { return p.is_clock && p.is_there; });
  if (is_row && time_) {
    append_seconds(line, *time_);
    for (const Part& part : parts_) {
      if (part.is_there) {
        part.table->append_row(line);
      } else {
        line.append(part.columns, ',');
      }
    }
    line += '\n';
  }
  for (Part& part : parts_) part.is_there = part.is_there && holds_ && !part.is_clock;
}

}  // namespace

Result<ExportReport> export_tables(const std::filesystem::path& trace, const std::filesystem::path& folder,
                                   const ExportOptions& options) {
  auto source = REHEARSE_TRY(ExportSource::open(trace, options));
  ExportReport report;
  auto outputs = REHEARSE_TRY(learn_columns(source, options.bytes, report));
  TopicNames names;
  for (auto& [id, output] : outputs) {
    output.topic.file = folder / (names.name_for(output.topic.topic) + ".csv");
    output.topic.columns = 1 + static_cast<std::int64_t>(output.table->columns().size());
    REHEARSE_TRY(check_replaceable(output.topic.file, table_magic, "table of Rehearse"));
  }
  REHEARSE_TRY(make_folder(folder));
  LineFiles files;
  for (const auto& [id, output] : outputs) {
    REHEARSE_TRY(files.begin(output.topic.file, heading(output.table->columns())));
  }
  std::string line;
  REHEARSE_TRY(source.pass([&](const mcap::Message& message) -> Result<void> {
    const auto output = outputs.find(message.channel->id);
    if (output == outputs.end() || !output->second.table->read(message.data)) return {};
    line.clear();
    append_seconds(line, message.log_time);
    output->second.table->append_row(line);
    line += '\n';
    return files.append(output->second.topic.file, line);
  }));
  REHEARSE_TRY(files.finish());
  for (auto& [id, output] : outputs) {
    note_left_out(output.topic.topic, *output.table, report);
    report.written.push_back(std::move(output.topic));
  }
  report.damage = source.damage();
  return report;
}

Result<ExportReport> export_joined(const std::filesystem::path& trace, const std::filesystem::path& file,
                                   const ExportOptions& options) {
  auto source = REHEARSE_TRY(ExportSource::open(trace, options));
  REHEARSE_TRY(check_replaceable(file, table_magic, "table of Rehearse"));
  ExportReport report;
  auto joined = REHEARSE_TRY(JoinedTable::learn(source, options.clock, report));
  if (!joined.has_rows() && !options.clock.empty())
    return error(fmt::format("{}: no selected message is a series of numbers on '{}', so there are no rows",
                             trace.string(), options.clock),
                 "rehearse info lists the topics");
  if (!joined.has_rows())
    return error(fmt::format("{}: no selected message is a tick, so there are no rows to join by", trace.string()),
                 "select /tick too; of a log without ticks, --clock TOPIC names the topic that makes the rows");
  LineFiles files;
  REHEARSE_TRY(files.begin(file, joined.heading_line()));
  ExportedTopic all{file, "", 0, joined.columns(), 0};
  std::string line;
  const auto put_row = [&]() -> Result<void> {
    if (line.empty()) return {};
    ++all.rows;
    const auto appended = files.append(file, line);
    line.clear();
    return appended;
  };
  REHEARSE_TRY(source.pass([&](const mcap::Message& message) -> Result<void> {
    joined.take(message, line);
    return put_row();
  }));
  joined.end_row(line);
  REHEARSE_TRY(put_row());
  REHEARSE_TRY(files.finish());
  joined.note_all_left_out(report);
  report.written.push_back(std::move(all));
  report.damage = source.damage();
  return report;
}

}  // namespace rehearse
