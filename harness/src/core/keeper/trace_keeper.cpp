#include "trace_keeper.h"

#include <fmt/format.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <optional>
#include <utility>

#include "base/quiet_thread.h"
#include "core/kinds/channel_name.h"
#include "core/trace/run_facts.h"
#include "trace_call.h"

namespace rehearse {

using trace_call::Head;
using trace_call::Kind;

namespace {

/// Reads the rest of a message.
template <class Call>
bool read_call(Bytes rest, Call& call) {
  CdrReader reader(rest);
  return msg::decode(reader, call);
}

std::vector<std::byte> encoded(const auto& message) {
  CdrWriter cdr;
  msg::encode(message, cdr);
  return {cdr.bytes().begin(), cdr.bytes().end()};
}

}  // namespace

/// A recording that the child writes.
struct TraceKeeper::Kept {
  std::unique_ptr<mcap::Writer> writer;
  std::string file, name;  // an absolute path, and the name in diagnostics
  Diagnostics errors;      // of calls that have no answer
  std::size_t schemas = 0, channels = 0;
  std::optional<std::uint16_t> event_channel, tick_channel;  // once they are added
  std::int64_t ticks = 0;
  std::uint64_t last_time = 0;  // log time of the last message [ns]
  struct Pending {
    Head head;
    std::vector<std::byte> data;
  };
  std::vector<Pending> pending;   // the messages of the tick that is under way
  std::size_t pending_count = 0;  // of them; the memory of the others is reused
  std::map<std::string, mcap::StringMap> at_failure;

  Result<void> create(Bytes rest);
  /// Carries out a call. False: no such call.
  bool call(const Head& head, Bytes rest, Result<void>& result);
  bool add_channel(Bytes rest);
  bool has_channel(std::uint16_t id) const { return static_cast<std::uint16_t>(id - 1) < channels; }
  bool count(const Head& head) { return count(head.channel, 1, head.log_time); }
  bool count(std::uint16_t channel, std::uint64_t messages, std::uint64_t last);
  bool copy_chunk(Bytes rest, Result<void>& result);
  void write_pending();
};

Result<void> TraceKeeper::Kept::create(Bytes rest) {
  trace_call::Create call;
  if (!read_call(rest, call)) return error("the call can't be read");
  file = call.file;
  name = call.name;
  writer = REHEARSE_TRY(mcap::Writer::create(file, trace_call::form_of_recordings()));
  return {};
}

bool TraceKeeper::Kept::add_channel(Bytes rest) {
  trace_call::AddChannel call;
  if (!read_call(rest, call) || call.schema > schemas) return false;
  const std::uint16_t id =
      writer->add_channel(call.schema, call.topic, call.encoding, trace_call::map_of(call.metadata),
                          {call.group, static_cast<mcap::Compression>(call.compression)});
  ++channels;
  if (call.topic == run_topics::events) event_channel = id;
  if (call.topic == run_topics::tick) tick_channel = id;
  return true;
}

/// Counts messages of a channel, whose last has that log time [ns]; false: there is no such channel.
bool TraceKeeper::Kept::count(std::uint16_t channel, std::uint64_t messages, std::uint64_t last) {
  if (!has_channel(channel)) return false;
  if (channel == tick_channel) {
    ticks += static_cast<std::int64_t>(messages);
    pending_count = 0;
  }
  last_time = std::max(last_time, last);
  return true;
}

bool TraceKeeper::Kept::copy_chunk(Bytes rest, Result<void>& result) {
  const auto stored = mcap::StoredChunk::parse(rest);
  if (!stored || stored->bytes.size() != rest.size()) return false;
  for (const mcap::StoredChunk::Index& index : stored->indexes)
    if (!count(index.channel, index.count, stored->chunk.end_time)) return false;
  result = writer->copy_chunk(*stored);
  return true;
}

void TraceKeeper::Kept::write_pending() {
  for (const Pending& message : std::span(pending).first(std::exchange(pending_count, 0)))
    if (count(message.head))
      static_cast<void>(
          writer->write(message.head.channel, message.head.log_time, message.head.publish_time, message.data));
}

bool TraceKeeper::Kept::call(const Head& head, Bytes rest, Result<void>& result) {
  switch (head.kind) {
    case Kind::add_schema: {
      trace_call::AddSchema call;
      if (!read_call(rest, call)) return false;
      schemas = std::max<std::size_t>(schemas, writer->add_schema(call.name, call.encoding, call.data));
      return true;
    }
    case Kind::add_channel: return add_channel(rest);
    case Kind::write: {
      if (!count(head)) return false;
      const auto sequence = head.numbered == 1 ? std::optional(static_cast<std::uint32_t>(head.number)) : std::nullopt;
      result = writer->write(head.channel, head.log_time, head.publish_time, rest, sequence);
      return true;
    }
    case Kind::write_later:
      if (!count(head) || !head.compose) return false;
      result = writer->write_later(head.channel, head.log_time, head.publish_time, head.number,
                                   {rest.begin(), rest.end()}, head.compose);
      return true;
    case Kind::begin_pending: pending_count = 0; return true;
    case Kind::write_pending:
      if (!has_channel(head.channel)) return false;
      if (pending_count == pending.size()) pending.emplace_back();
      pending[pending_count].head = head;
      pending[pending_count++].data.assign(rest.begin(), rest.end());
      return true;
    case Kind::copy_chunk: return copy_chunk(rest, result);
    case Kind::add_attachment: {
      trace_call::AddAttachment call;
      if (!read_call(rest, call)) return false;
      result = writer->add_attachment(call.name, call.media_type, std::as_bytes(std::span(call.data)), call.log_time,
                                      call.create_time);
      return true;
    }
    case Kind::add_metadata:
    case Kind::add_at_failure: {
      trace_call::AddMetadata call;
      if (!read_call(rest, call)) return false;
      if (head.kind == Kind::add_metadata)
        result = writer->add_metadata(call.name, trace_call::map_of(call.values));
      else
        at_failure[call.name] = trace_call::map_of(call.values);
      return true;
    }
    case Kind::status: return true;
    case Kind::flush: result = writer->flush(); return true;
    case Kind::close: result = writer->close(); return true;
    default: return false;
  }
}

TraceKeeper::TraceKeeper(Ring& ring) : from_child_(ring), thread_(start_quiet_thread([this] { run(); })) {}

TraceKeeper::~TraceKeeper() { finish(); }

void TraceKeeper::drop_traces() { traces_.clear(); }

void TraceKeeper::finish() {
  child_ended_ = true;
  from_child_.end_wait();
  if (thread_.joinable()) thread_.join();
}

void TraceKeeper::run() {
  constexpr std::chrono::milliseconds rest{10}, rest_without_traces{500};  // the first call of a trace ends both
  std::vector<std::byte> message;
  for (;;) {
    const bool is_last_look = child_ended_;
    switch (from_child_.receive(message)) {
      case RingReader::Got::message:
        if (take(message)) break;
        [[fallthrough]];
      case RingReader::Got::damaged: damaged_ = true; return;
      case RingReader::Got::nothing:
        if (is_last_look) return;
        from_child_.wait(traces_.empty() ? rest_without_traces : rest);
    }
  }
}

/// Carries out the call, and answers it if the child waits for that. False: it makes no sense.
bool TraceKeeper::take(std::vector<std::byte>& message) {
  Head head;
  if (message.size() < sizeof head) return false;
  std::memcpy(&head, message.data(), sizeof head);
  const Bytes rest = Bytes(message).subspan(sizeof head);
  const auto known = traces_.find(head.trace);
  if (head.kind == Kind::drop) {
    if (known != traces_.end()) traces_.erase(known);
    return true;
  }
  if (head.kind == Kind::abandon) return true;  // the process probably ends: then close_failed() closes it
  Result<void> result;
  const bool is_new = head.kind == Kind::create;
  if (is_new != (known == traces_.end())) return false;
  Kept* kept = nullptr;
  if (is_new) {
    auto created = std::make_unique<Kept>();
    kept = created.get();
    traces_[head.trace] = std::move(created);
    result = kept->create(rest);
  } else {
    kept = known->second.get();
    if (!kept->call(head, rest, result)) return false;
  }
  const bool answered = is_new || head.kind == Kind::status || head.kind == Kind::flush || head.kind == Kind::close;
  if (!result && !answered && kept->errors.empty()) {
    kept->errors = result.errors();
    from_child_.note_failure();
  }
  if (!answered) return true;
  trace_call::Answer answer;
  for (const Diagnostic& one : !result ? result.errors() : kept->errors)
    answer.errors.push_back({one.file == kept->file ? kept->name : one.file, one.message, one.hint});
  if (kept->writer) {
    answer.changed_by_others = kept->writer->is_changed_by_others();
    answer.deadline = kept->writer->deadline();
  }
  from_child_.answer(encoded(answer));
  const bool ends = (is_new && !result) || head.kind == Kind::close;
  if (ends) traces_.erase(head.trace);
  return true;
}

std::vector<std::string> TraceKeeper::close_failed(const Failure& failure) {
  std::vector<std::string> lines;
  for (auto& [number, kept] : traces_) {
    mcap::Writer& writer = *kept->writer;
    kept->write_pending();
    // calls outside of the run have no time of their own
    const auto now = std::max(static_cast<std::uint64_t>(std::llround(failure.time * 1e9)), kept->last_time);
    const msg::Event event{msg::Time::from_ns(now), failure.tick, "error", failure.source, failure.sentence};
    if (kept->event_channel) static_cast<void>(writer.write(*kept->event_channel, now, now, encoded(event)));
    for (const auto& [name, values] : kept->at_failure) static_cast<void>(writer.add_metadata(name, values));
    const RunOutcome outcome{.ticks = kept->ticks, .complete = false, .failure = failure.sentence};
    static_cast<void>(writer.add_metadata(records::outcome, outcome.metadata()));
    const Result<void> closed = writer.close();                     // it returns the error of an earlier call, too
    const double end = static_cast<double>(kept->last_time) / 1e9;  // [s]
    lines.push_back(closed ? fmt::format("the trace up to there: {} ({:g} s)", kept->name, end)
                           : to_string(closed.errors()));
  }
  traces_.clear();
  return lines;
}

}  // namespace rehearse
