#include "recorded_outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>

#include "output_record.h"

namespace rehearse {
namespace {

constexpr double not_recorded = std::numeric_limits<double>::quiet_NaN();

}  // namespace

RecordedOutputs::RecordedOutputs(const ControllerHost& host, const std::vector<OutputField>& fields,
                                 const mcap::Reader& trace, RowJudge& judge)
    : host_(host), fields_(fields), judge_(judge) {
  for (std::size_t word = 0; word < fields.size(); ++word)
    words_.emplace(std::pair(fields[word].channel, fields[word].element), word);
  for (const auto& [id, channel] : trace.channels()) {
    const ChannelName name = ChannelName::parse(channel.topic);
    for (const HostedController& hosted : host.controllers())
      if (name.is_of(hosted.label, ChannelSide::output) && name.kind != ChannelKind::delay)
        add_channel(trace, channel, hosted);
  }
  sort_words();
}

void RecordedOutputs::add_channel(const mcap::Reader& trace, const mcap::Channel& channel,
                                  const HostedController& hosted) {
  auto added = std::make_unique<Channel>(channel, trace.schema_of(channel));
  added->hosted = &hosted;
  added->commanded = word_of(channel.topic, "commanded");
  added->judged = judge_.add_channel(added->rows.table);
  by_id_[channel.id] = std::move(added);
  channels_.push_back(channel.id);
}

/// Finds the words that are compared although the recording lacks them.
void RecordedOutputs::sort_words() {
  for (const HostedController& hosted : host_.controllers()) {
    for (std::size_t word = 0; word < fields_.size(); ++word) {
      const OutputField& field = fields_[word];
      if (field.controller != hosted.label) continue;
      if (field.channel == run_topics::tick) continue;
      const bool of_device = word_of(field.channel, "commanded") != none;
      const auto is_recorded = [&](const auto& entry) { return entry.second->topic() == field.channel; };
      if (!of_device)
        commands_.push_back({word, &hosted});
      else if (field.kind == CellKind::boolean && std::ranges::none_of(by_id_, is_recorded))
        uncommanded_.push_back({word, &hosted});
    }
  }
}

std::size_t RecordedOutputs::word_of(const std::string& channel, const std::string& element) const {
  const auto found = words_.find(std::pair(channel, element));
  return found == words_.end() ? none : found->second;
}

/// Finds the words of the columns.
void RecordedOutputs::find_columns(Channel& channel) {
  new_columns_ = true;
  channel.columns = channel.rows.table.columns;
  channel.words.clear();
  channel.unmatched.clear();
  for (std::size_t i = 0; i < channel.columns.size(); ++i) {
    channel.words.push_back(word_of(channel.topic(), channel.columns[i].element));
    if (channel.words.back() == none) channel.unmatched.push_back(i);
  }
  if (channel.kind == ChannelKind::device_state) {
    const auto element = [&] { return fmt::format("values/{}", channel.columns.size()); };
    for (std::size_t word; (word = word_of(channel.topic(), element())) != none;) {
      channel.columns.push_back({element(), {}, CellKind::floating});
      channel.words.push_back(word);
    }
  }
  channel.expected.assign(channel.columns.size(), std::bit_cast<std::uint64_t>(not_recorded));
  channel.actual = channel.expected;
  judge_.set_columns(channel.judged, channel.columns);
}

/// Finds the fields that no message of this tick contains, if other channels have messages than in the last tick.
void RecordedOutputs::find_unpaired() {
  const auto is_known = [](const auto& entry) { return entry.second->here == entry.second->was_here; };
  if (!new_columns_ && std::ranges::all_of(by_id_, is_known)) return;
  new_columns_ = false;
  std::vector<bool> recorded(fields_.size(), false);
  for (auto& [id, channel] : by_id_) {
    channel->was_here = channel->here;
    for (const std::size_t word : channel->words)
      if (channel->here && word != none) recorded[word] = true;
  }
  unpaired_.clear();
  std::ranges::copy_if(commands_, std::back_inserter(unpaired_), [&](const Word& at) { return !recorded[at.word]; });
}

void RecordedOutputs::begin_tick() {
  for (auto& [id, channel] : by_id_) channel->here = false;
}

Result<void> RecordedOutputs::read(Channel& channel, const mcap::Message& message) {
  const std::size_t known = channel.rows.table.columns.size();
  if (!channel.rows.has_rows() || !channel.rows.replace(message.log_time, message.data))
    return error(fmt::format("a message on {} at {} ns is not of its type", channel.topic(), message.log_time));
  if (channel.rows.table.columns.size() != known || channel.columns.empty()) find_columns(channel);
  const std::uint64_t* row = channel.rows.table.row(0);
  std::copy(row, row + channel.rows.table.columns.size(), channel.expected.begin());
  return {};
}

Result<void> RecordedOutputs::accept(const mcap::Message& message) {
  Channel& channel = *by_id_.at(message.channel->id);
  channel.here = true;
  return read(channel, message);
}

Result<void> RecordedOutputs::accept_later(const mcap::Message& message, std::int64_t tick) {
  Channel& channel = *by_id_.at(message.channel->id);
  REHEARSE_TRY(read(channel, message));
  judge_.add_golden(channel.judged, tick, channel.expected);
  return {};
}

void RecordedOutputs::pass_over(std::int64_t tick) {
  for (const auto& [id, channel] : by_id_)
    if (channel->here && judge_.needs_equal_rows(channel->judged))
      judge_.add_golden(channel->judged, tick, channel->expected);
}

std::int64_t RecordedOutputs::compare(std::int64_t tick, const std::vector<std::uint64_t>& row,
                                      const OnDifference& differs) {
  std::int64_t compared = 0;
  find_unpaired();
  for (const auto& [id, channel] : by_id_) compared += compare_channel(*channel, tick, row, differs);
  for (const Word& at : uncommanded_)
    if (auto found = difference(fields_[at.word], 0, row[at.word]); found && at.hosted->running)
      differs(*std::move(found));
  for (const Word& at : unpaired_) {
    if (!at.hosted->running) continue;
    Divergence found = place_of(fields_[at.word]);
    found.note = "the controller commands it now, but didn't in the recording";
    differs(std::move(found));
  }
  return compared;
}

/// Reports the recorded numbers that no controller commands now. A NaN of a joint is none: the recorded controller
/// didn't command it either.
std::int64_t RecordedOutputs::compare_unmatched(const Channel& channel, const OnDifference& differs) const {
  std::int64_t compared = 0;
  const auto report = [&](std::size_t column) {
    const auto expected = std::bit_cast<double>(channel.expected[column]);
    const bool of_joints = channel.kind == ChannelKind::joints || channel.kind == ChannelKind::joint_accelerations;
    if (of_joints && channel.words[column] == none && std::isnan(expected)) return;
    const std::string& element = channel.columns[column].element;
    Divergence found = place_of({channel.hosted->label, channel.topic(), element});
    put_numbers(found, expected, not_recorded, unit_of(channel.rows.table.metadata, element));
    found.note = "the controller no longer commands it";
    ++compared;
    differs(std::move(found));
  };
  if (channel.hosted->running) {
    std::ranges::for_each(channel.unmatched, report);
  } else {
    for (std::size_t column = 0; column < channel.columns.size(); ++column) report(column);
  }
  return compared;
}

std::int64_t RecordedOutputs::compare_channel(Channel& channel, std::int64_t tick,
                                              const std::vector<std::uint64_t>& row, const OnDifference& differs) {
  if (channel.commanded != none) {
    auto found = difference(fields_[channel.commanded], channel.here ? 1 : 0, row[channel.commanded]);
    if (found) differs(*std::move(found));
    if (found) return 1;
  }
  if (!channel.here) return 0;
  if (!channel.hosted->running) return compare_unmatched(channel, differs);
  bool equal = true;
  for (std::size_t column = 0; column < channel.words.size(); ++column) {
    const std::size_t word = channel.words[column];
    channel.actual[column] = word == none ? channel.expected[column] : row[word];
    equal = equal && channel.actual[column] == channel.expected[column];
  }
  if (!equal || judge_.needs_equal_rows(channel.judged))
    judge_.add(channel.judged, tick, channel.expected, channel.actual);
  return std::ssize(channel.words) - std::ssize(channel.unmatched) + compare_unmatched(channel, differs);
}

}  // namespace rehearse
