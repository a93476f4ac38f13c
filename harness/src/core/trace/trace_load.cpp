#include "trace_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <numeric>

#include "base/hashing.h"
#include "core/kinds/channel_name.h"
#include "core/ros2msg/message_format.h"
#include "core/ros2msg/ros2msg.h"
#include "message_rest.h"
#include "trace_windows.h"

namespace rehearse {

// Schemas of other programs may be wrong, or have types that can't be decoded: their messages have no series, only
// bytes.
ChannelSource::ChannelSource(const mcap::Channel& channel, const mcap::Schema* schema, std::vector<TraceColumn> columns)
    : rows(channel, schema, std::move(columns)),
      rest(rows.has_rows() ? MessageRest::make(rows.table.type, rows.table.encoding, schema) : nullptr) {}

void ChannelSource::take_samples(const StateRate* rate) {
  samples = rate && rate->reduces(rows.table.topic) ? rate : nullptr;
}

void ChannelSource::keep_undecoded(const mcap::Schema* of) {
  schema = of;
  rows.keeps_undecoded = schema != nullptr;
}

namespace {

std::string problem_of(mcap::Bytes payload, const std::string& encoding, const mcap::Schema& schema) {
  auto parsed = ros2msg::schema_of(encoding, schema);
  if (!parsed) return parsed.errors()[0].message;
  ros2msg::Decoder decoder(std::move(*parsed));
  decoder.decode(payload, [](const ros2msg::Value&) {});
  return decoder.problem().empty() ? "it isn't a valid " + schema.name : decoder.problem();
}

}  // namespace

bool ChannelSource::add(const mcap::Message& message) {
  if (samples && !samples->is_sample(message.log_time)) return true;
  TraceChannel& table = rows.table;
  if (!rows.add(message.log_time, message.data)) {
    if (!schema) return false;
    table.undecoded.push_back({table.times.size() - 1, problem_of(message.data, table.encoding, *schema)});
  }
  if (!rows.is_typed()) table.locations.push_back(message.location);
  table.hashes.push_back(hash_bytes(message.data.data(), message.data.size()));
  if (rest && rest->take(message.data, message.log_time))
    table.rests.push_back({table.times.size() - 1, rest->hash(), message.location});
  return true;
}

void drop_messages(TraceChannel& table, std::size_t count) {
  const auto drop = [](auto& values, std::size_t some) {
    values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(std::min(some, values.size())));
  };
  drop(table.cells, count * table.columns.size());
  drop(table.locations, count);
  drop(table.hashes, count);
  std::vector<TraceRest> rests;
  for (std::size_t i = 0; i < table.rests.size() && count < table.messages(); ++i) {
    const bool is_over = i + 1 < table.rests.size() && table.rests[i + 1].first <= count;
    if (is_over) continue;
    rests.push_back(table.rests[i]);
    rests.back().first -= std::min(rests.back().first, count);
  }
  table.rests = std::move(rests);
  std::erase_if(table.undecoded, [count](const UndecodedMessage& message) { return message.index < count; });
  for (UndecodedMessage& message : table.undecoded) message.index -= count;
  drop(table.times, count);
  table.earlier += count;
}

namespace {

/// Adds the groups of `width` values at some places, in that order; none if there are no values.
template <class T>
void append_values(std::vector<T>& to, const std::vector<T>& values, const std::vector<std::size_t>& order,
                   std::size_t width = 1) {
  if (values.empty()) return;
  for (const std::size_t from : order)
    for (std::size_t i = 0; i < width; ++i) to.push_back(values[from * width + i]);
}

}  // namespace

void append_messages(TraceChannel& to, const TraceChannel& from, const std::vector<std::size_t>& messages) {
  const std::size_t earlier = to.messages();
  append_values(to.times, from.times, messages);
  append_values(to.cells, from.cells, messages, from.columns.size());
  append_values(to.locations, from.locations, messages);
  append_values(to.hashes, from.hashes, messages);
  for (std::size_t i = 0; i < messages.size() && !from.rests.empty(); ++i) {
    const TraceRest& rest = *from.rest_of(messages[i]);
    if (to.rests.empty() || to.rests.back().hash != rest.hash)
      to.rests.push_back({earlier + i, rest.hash, rest.location});
  }
  for (std::size_t i = 0; i < messages.size() && !from.undecoded.empty(); ++i)
    if (const std::string* problem = from.problem_of(messages[i])) to.undecoded.push_back({earlier + i, *problem});
}

/// Builds a Trace in one pass over its file: the whole trace, or piece after piece.
class TraceLoader {
 public:
  TraceLoader(const std::filesystem::path& file, Trace::Damage damage, Trace::OnPiece on_piece = {},
              std::size_t piece_size = 0, const StateRate* samples = nullptr)
      : file_(file),
        tolerant_(damage == Trace::Damage::tolerate),
        on_piece_(std::move(on_piece)),
        piece_size_(piece_size) {
    if (samples) trace_.state_samples_ = std::make_shared<const StateRate>(*samples);
  }

  /// Messages that can't be decoded are no damage, unless the file has ticks.
  void keep_undecoded() { trace_.keeps_undecoded_ = true; }
  /// Messages are read in the order of time.
  void sort_by_time() { sorts_ = true; }
  /// `wanted`: the channels whose messages are read; null: all.
  Result<Trace> load(const std::function<bool(const mcap::Channel&)>& wanted = {});
  Result<Trace> outline();
  Result<Trace> sizes();
  static Trace overlap(const Trace& whole, const Trace& part);

 private:
  Result<void> open(const mcap::ReaderOptions& options);
  using Source = ChannelSource;

  Source& source_of(const mcap::Message& message);
  void add_message(const mcap::Message& message);
  template <class T>
  void add_decoded(const mcap::Message& message, std::vector<T>& to);
  bool ends_a_tick(const mcap::Message& message) const;
  void end_piece();
  void empty_tables();
  void assemble();
  void complain(std::string message);

  const std::filesystem::path file_;
  const bool tolerant_;
  const Trace::OnPiece on_piece_;
  const std::size_t piece_size_;
  Trace trace_;
  std::vector<msg::ContactChange> earlier_changes_;  // of earlier pieces
  bool has_ticks_ = false;
  bool sorts_ = false;
  std::size_t held_ = 0;  // approximate size of the tables [bytes]
  std::map<std::uint16_t, std::unique_ptr<Source>> sources_;
  std::vector<Source*> by_id_;  // up to the largest id of a message
  Diagnostics problems_;
};

namespace {

/// Some messages of a channel, in that order.
TraceChannel messages_at(const TraceChannel& channel, const std::vector<std::size_t>& order) {
  TraceChannel taken;
  taken.topic = channel.topic;
  taken.type = channel.type;
  taken.encoding = channel.encoding;
  taken.metadata = channel.metadata;
  taken.columns = channel.columns;
  taken.times.reserve(order.size());
  taken.hashes.reserve(order.size());
  taken.cells.reserve(order.size() * channel.columns.size());
  append_messages(taken, channel, order);
  return taken;
}

/// Sorts the messages of a channel by their times; messages of equal times keep their order.
void put_in_order(TraceChannel& channel) {
  if (std::ranges::is_sorted(channel.times)) return;
  std::vector<std::size_t> order(channel.messages());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return channel.times[a] < channel.times[b]; });
  channel = messages_at(channel, order);
}

}  // namespace

Result<void> TraceLoader::open(const mcap::ReaderOptions& options) {
  auto reader = REHEARSE_TRY(mcap::Reader::open(file_, options));
  trace_.file_ = file_.string();
  trace_.events_ = std::make_shared<std::vector<msg::Event>>();
  trace_.contact_changes_ = std::make_shared<std::vector<msg::ContactChange>>();
  trace_.reader_ = std::move(reader);
  return {};
}

Result<Trace> TraceLoader::load(const std::function<bool(const mcap::Channel&)>& wanted) {
  REHEARSE_TRY(open({}));
  std::vector<std::uint16_t> chosen;
  for (const auto& [id, channel] : trace_.reader_->channels()) {
    const mcap::Schema* schema = trace_.reader_->schema_of(channel);
    has_ticks_ = has_ticks_ || (schema != nullptr && schema->name == msg::Tick::type_name);
    if (wanted && wanted(channel)) chosen.push_back(id);
  }
  trace_.keeps_undecoded_ = trace_.keeps_undecoded_ && !has_ticks_;
  const auto take = [this](const mcap::Message& message) {
    add_message(message);
    if (on_piece_ && held_ >= piece_size_ && ends_a_tick(message)) end_piece();
    return tolerant_ || problems_.empty();
  };
  const bool reads = !wanted || !chosen.empty();
  const auto read_all = [&] {
    return sorts_ ? trace_.reader_->for_each_message_in_order(take, chosen)
                  : trace_.reader_->for_each_message(take, chosen);
  };
  const auto pass = reads ? read_all() : Result<void>();
  if (!pass) problems_.insert(problems_.begin(), pass.errors().begin(), pass.errors().end());
  if (!problems_.empty() && !tolerant_) return problems_;
  trace_.damage_ = std::move(problems_);
  assemble();
  if (on_piece_) {
    on_piece_(trace_);
    empty_tables();
    trace_.contact_changes_->swap(earlier_changes_);
  } else {
    for (TraceChannel& channel : trace_.channels_) put_in_order(channel);
  }
  const auto earlier = [](const auto& a, const auto& b) { return a.stamp.to_ns() < b.stamp.to_ns(); };
  if (on_piece_)
    trace_.events_.reset();
  else
    std::ranges::stable_sort(*trace_.events_, earlier);
  std::ranges::stable_sort(*trace_.contact_changes_, earlier);
  return std::move(trace_);
}

Trace TraceLoader::overlap(const Trace& whole, const Trace& part) {
  Trace found;
  found.file_ = whole.file_;
  found.reader_ = whole.reader_;
  found.state_samples_ = whole.state_samples_;
  found.series_ = whole.series_;
  found.events_ = std::make_shared<std::vector<msg::Event>>();
  found.contact_changes_ = std::make_shared<std::vector<msg::ContactChange>>();
  for (const TraceChannel& channel : whole.channels_) {
    const TraceChannel* other = part.find_channel(channel.topic);
    const auto has = [&](std::uint64_t time) { return other && std::ranges::binary_search(other->times, time); };
    std::vector<std::size_t> common;
    for (std::size_t message = 0; message < channel.messages(); ++message)
      if (has(channel.times[message])) common.push_back(message);
    found.channels_.push_back(messages_at(channel, common));
    const auto copy = [&](const auto& all, auto& to) {
      std::ranges::copy_if(all, std::back_inserter(to), [&](const auto& one) { return has(one.stamp.to_ns()); });
    };
    if (channel.type == msg::Event::type_name) copy(whole.events(), *found.events_);
    if (channel.type == msg::ContactChange::type_name) copy(*whole.contact_changes_, *found.contact_changes_);
  }
  return found;
}

/// True at the end of a tick, when its numbers are complete.
bool TraceLoader::ends_a_tick(const mcap::Message& message) const {
  if (!has_ticks_) return true;
  const mcap::Schema* schema = trace_.reader_->schema_of(*message.channel);
  return schema != nullptr && schema->name == msg::Tick::type_name;
}

/// Passes on the piece read so far and continues with empty tables of the same columns.
void TraceLoader::end_piece() {
  assemble();
  on_piece_(trace_);
  empty_tables();
  std::size_t next = 0;
  for (const auto& [id, channel] : trace_.reader_->channels()) {
    TraceChannel& table = trace_.channels_[next++];
    const auto source = sources_.find(id);
    if (source == sources_.end()) continue;
    if (source->second->rest) source->second->rest->forget();
    source->second->rows.table = std::move(table);
  }
  trace_.channels_.clear();
  trace_.series_.clear();
  held_ = 0;
}

/// Empties the tables of all channels and removes the events; keeps the changes of contact.
void TraceLoader::empty_tables() {
  for (TraceChannel& table : trace_.channels_) drop_messages(table, table.messages());
  trace_.events_->clear();
  std::vector<msg::ContactChange>& changes = *trace_.contact_changes_;
  earlier_changes_.insert(earlier_changes_.end(), std::make_move_iterator(changes.begin()),
                          std::make_move_iterator(changes.end()));
  changes.clear();
}

/// Makes the trace of the tables.
void TraceLoader::assemble() {
  for (const auto& [id, channel] : trace_.reader_->channels()) {
    const auto source = sources_.find(id);
    trace_.channels_.push_back(source != sources_.end()
                                   ? std::move(source->second->rows.table)
                                   : describe_channel(channel, trace_.reader_->schema_of(channel)));
  }
  std::vector<TraceChannel*> channels;
  for (TraceChannel& channel : trace_.channels_) channels.push_back(&channel);
  name_series(channels, trace_.series_);
}

TraceLoader::Source& TraceLoader::source_of(const mcap::Message& message) {
  const mcap::Channel& channel = *message.channel;
  if (channel.id >= by_id_.size()) by_id_.resize(std::size_t{channel.id} + 1, nullptr);
  Source*& known = by_id_[channel.id];
  if (known != nullptr) return *known;
  auto& source = sources_[channel.id];
  source = std::make_unique<Source>(channel, trace_.reader_->schema_of(channel));
  source->take_samples(trace_.state_samples_.get());
  if (trace_.keeps_undecoded_) source->keep_undecoded(trace_.reader_->schema_of(channel));
  known = source.get();
  return *known;
}

void TraceLoader::add_message(const mcap::Message& message) {
  Source& source = source_of(message);
  TraceChannel& table = source.rows.table;
  if (!source.add(message))
    return complain(fmt::format("topic {}: message {} isn't a valid {}", table.topic,
                                table.earlier + table.times.size(), table.type));
  held_ += sizeof(std::uint64_t) * (1 + table.columns.size()) + (source.rows.is_typed() ? 0 : sizeof(mcap::Location));
  if (table.encoding != "cdr") return;
  if (table.type == msg::Event::type_name) {
    add_decoded(message, *trace_.events_);
    held_ += message.data.size() + sizeof(msg::Event);
  }
  if (table.type == msg::ContactChange::type_name) add_decoded(message, *trace_.contact_changes_);
}

template <class T>
void TraceLoader::add_decoded(const mcap::Message& message, std::vector<T>& to) {
  CdrReader reader(message.data);
  T decoded;
  if (msg::decode(reader, decoded)) {
    to.push_back(std::move(decoded));
  } else {
    complain(fmt::format("topic {}: a message isn't a valid {}", message.channel->topic, T::type_name));
  }
}

void TraceLoader::complain(std::string message) {
  constexpr std::size_t limit = 50;
  if (problems_.size() < limit) problems_.push_back(error_in(trace_.file_, std::move(message)));
}

TraceWindows::TraceWindows(const Trace& whole, std::span<const std::size_t> channels, const WindowsStart& start)
    : trace_(whole) {
  std::vector<std::uint16_t> ids;
  trace_.events_ = std::make_shared<std::vector<msg::Event>>();
  trace_.contact_changes_ = std::make_shared<std::vector<msg::ContactChange>>();
  for (const auto& [id, channel] : trace_.reader_->channels()) {
    TraceChannel& table = trace_.channels_[sources_.size()];
    if (std::ranges::find(channels, sources_.size()) != channels.end()) ids.push_back(id);
    if (id >= by_id_.size()) by_id_.resize(std::size_t{id} + 1, nullptr);
    by_id_[id] = &sources_.emplace_back(channel, trace_.reader_->schema_of(channel), table.columns);
    by_id_[id]->take_samples(trace_.state_samples_.get());
    if (trace_.keeps_undecoded_) by_id_[id]->keep_undecoded(trace_.reader_->schema_of(channel));
    table = std::move(by_id_[id]->rows.table);
  }
  for (std::size_t i = 0; i < start.earlier.size(); ++i) trace_.channels_[channels[i]].earlier = start.earlier[i];
  messages_ = std::make_unique<mcap::OrderedMessages>(*trace_.reader_, ids, start.time);
  message_ = messages_->next();
}

void TraceWindows::move(std::uint64_t keep_from, std::uint64_t until) {
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    ChannelSource& source = sources_[i];
    TraceChannel& table = source.rows.table = std::move(trace_.channels_[i]);
    const auto kept = std::ranges::lower_bound(table.times, keep_from);
    drop_messages(table, static_cast<std::size_t>(kept - table.times.begin()));
    if (source.rest && table.times.empty()) source.rest->forget();
  }
  for (; message_ != nullptr && message_->log_time <= until; message_ = messages_->next())
    by_id_[message_->channel->id]->add(*message_);
  for (std::size_t i = 0; i < sources_.size(); ++i) trace_.channels_[i] = std::move(sources_[i].rows.table);
}

std::optional<std::uint64_t> TraceWindows::next_time() const {
  return message_ == nullptr ? std::nullopt : std::optional(message_->log_time);
}

Result<void> TraceWindows::verdict() { return messages_->verdict(); }

bool is_without_messages(const Trace& trace) {
  return std::ranges::any_of(trace.channels(),
                             [](const TraceChannel& table) { return table.earlier > 0 && table.times.empty(); });
}

void for_each_window(const Trace& trace, const std::vector<std::size_t>& channels,
                     const std::function<bool(const Trace& window)>& take) {
  constexpr std::uint64_t span = 1'000'000'000;  // [ns]
  if (!is_without_messages(trace)) {
    take(trace);
    return;
  }
  if (channels.empty()) return;
  TraceWindows windows(trace, channels);
  while (const auto begin = windows.next_time()) {
    windows.move(*begin, *begin + span);
    if (!take(windows.window())) return;
  }
}

void name_series(std::span<TraceChannel* const> channels, std::map<std::string, SeriesPlace, std::less<>>& series) {
  for (std::size_t c = 0; c < channels.size(); ++c) {
    TraceChannel& channel = *channels[c];
    const std::string topic = channel.topic.starts_with('/') ? channel.topic.substr(1) : channel.topic;
    // The last prefix is for a topic of two channels.
    for (const std::string& prefix : {series_name(topic, ""), topic + "/", fmt::format("{}#{}/", topic, c)}) {
      const bool taken = std::ranges::any_of(
          channel.columns, [&](const TraceColumn& column) { return series.contains(prefix + column.element); });
      if (taken) continue;
      for (std::size_t i = 0; i < channel.columns.size(); ++i) {
        channel.columns[i].series = prefix + channel.columns[i].element;
        series.emplace(channel.columns[i].series, SeriesPlace{c, i});
      }
      break;
    }
  }
}

Result<Trace> TraceLoader::outline() {
  REHEARSE_TRY(open({.opening = mcap::Opening::by_summary}));
  assemble();
  return std::move(trace_);
}

Result<Trace> TraceLoader::sizes() {
  REHEARSE_TRY(open({}));
  assemble();
  const auto& statistics = trace_.reader_->statistics();
  REHEARSE_ASSERT(statistics, "a file whose chunks can be copied has statistics");
  std::size_t next = 0;
  for (const auto& [id, channel] : trace_.reader_->channels()) {
    const auto count = statistics->channel_message_counts.find(id);
    trace_.channels_[next++].earlier = count == statistics->channel_message_counts.end() ? 0 : count->second;
  }
  return std::move(trace_);
}

Result<Trace> load_sizes(const std::filesystem::path& file) { return TraceLoader(file, Trace::Damage::refuse).sizes(); }

Result<Trace> Trace::outline(const std::filesystem::path& file) { return TraceLoader(file, Damage::refuse).outline(); }

Result<Trace> Trace::load(const std::filesystem::path& file, Damage damage) { return TraceLoader(file, damage).load(); }

Result<Trace> Trace::load_in_pieces(const std::filesystem::path& file, const OnPiece& on_piece,
                                    std::size_t piece_size) {
  return TraceLoader(file, Damage::refuse, on_piece, piece_size).load();
}

Result<Trace> load_pieces(const std::filesystem::path& file, const std::function<bool(const mcap::Channel&)>& wanted,
                          const Trace::OnPiece& on_piece, std::size_t piece_size, PieceOrder order,
                          Trace::Damage damage) {
  TraceLoader loader(file, damage, on_piece, piece_size);
  if (order == PieceOrder::of_time) loader.sort_by_time();
  return loader.load(wanted);
}

Trace overlap(const Trace& whole, const Trace& part) { return TraceLoader::overlap(whole, part); }

Result<Trace> load_samples(const std::filesystem::path& file, const StateRate& rate) {
  return TraceLoader(file, Trace::Damage::refuse, {}, 0, &rate).load();
}

Result<Trace> load_for_comparison(const std::filesystem::path& file, const StateRate* rate,
                                  const Trace::OnPiece& on_piece, std::size_t piece_size, Trace::Damage damage) {
  TraceLoader loader(file, damage, on_piece, piece_size, rate);
  loader.keep_undecoded();
  return loader.load();
}

}  // namespace rehearse
