#include "remote_writer.h"

#include <pthread.h>

#include <exception>
#include <limits>
#include <mutex>
#include <optional>
#include <utility>

#include "core/mcap/definitions.h"
#include "ring.h"
#include "trace_call.h"

namespace rehearse {
namespace {

using trace_call::Head;
using trace_call::Kind;

std::optional<RingWriter> to_parent;  // none: this process writes its recordings itself
std::uint32_t traces = 0;             // the number of the next Writer
bool shares_with_forks = false;

Bytes bytes_of(const Head& head) { return std::as_bytes(std::span(&head, 1)); }

Result<void> result_of(trace_call::Answer answer) {
  if (answer.errors.empty()) return {};
  Diagnostics errors;
  for (trace_call::Finding& one : answer.errors)
    errors.push_back(error_in(std::move(one.file), std::move(one.message), std::move(one.hint)));
  return errors;
}

/// Sends each call to the parent. Knows the ids of schemas and channels, which depend on the calls alone.
class RemoteWriter final : public SupervisedWriter {
 public:
  RemoteWriter() : trace_(traces++) {}
  ~RemoteWriter() override {
    if (to_parent) send({.kind = std::uncaught_exceptions() > 0 ? Kind::abandon : Kind::drop});
  }

  Result<void> create(const std::filesystem::path& file) {
    std::error_code failed;
    const std::filesystem::path place = std::filesystem::absolute(file, failed);
    return ask(Kind::create, trace_call::Create{failed ? file.string() : place.string(), file.string()});
  }

  std::uint16_t add_schema(std::string_view name, std::string_view encoding, std::string_view data) override {
    bool added = false;
    const std::uint16_t id = definitions_.add_schema(name, encoding, data, added);
    if (added || id == 0)
      send_encoded(Kind::add_schema,
                   trace_call::AddSchema{std::string(name), std::string(encoding), std::string(data)});
    return id;
  }

  std::uint16_t add_channel(std::uint16_t schema, std::string_view topic, std::string_view message_encoding,
                            mcap::StringMap metadata, mcap::ChunkGroup group) override {
    send_encoded(Kind::add_channel, trace_call::AddChannel{schema, std::string(topic), std::string(message_encoding),
                                                           trace_call::pairs_of(metadata), group.id,
                                                           static_cast<std::uint8_t>(group.compression)});
    if (!definitions_.has_room_for_a_channel()) return definitions_.channels().back().id;
    return definitions_.add_channel(schema, topic, message_encoding, {});
  }

  Result<void> write(std::uint16_t channel, std::uint64_t log_time, std::uint64_t publish_time, Bytes data,
                     std::optional<std::uint32_t> sequence) override {
    send({.kind = pending_ ? Kind::write_pending : Kind::write,
          .numbered = static_cast<std::uint8_t>(sequence ? 1 : 0),
          .channel = channel,
          .log_time = log_time,
          .publish_time = publish_time,
          .number = sequence.value_or(0)},
         data);
    return pending_ ? Result<void>() : status(log_time);
  }

  Result<void> write_later(std::uint16_t channel, std::uint64_t log_time, std::uint64_t publish_time, std::size_t held,
                           std::vector<std::byte> raw, mcap::Compose compose) override {
    send({.kind = Kind::write_later,
          .channel = channel,
          .log_time = log_time,
          .publish_time = publish_time,
          .number = held,
          .compose = compose},
         raw);
    return status(log_time);
  }

  Result<void> copy_chunk(const mcap::StoredChunk& chunk) override {
    send({.kind = Kind::copy_chunk}, chunk.bytes);
    return status();
  }

  Result<void> add_attachment(std::string_view name, std::string_view media_type, Bytes data, std::uint64_t log_time,
                              std::uint64_t create_time) override {
    const auto* first = reinterpret_cast<const std::uint8_t*>(data.data());
    send_encoded(Kind::add_attachment,
                 trace_call::AddAttachment{std::string(name), std::string(media_type), log_time, create_time,
                                           std::vector<std::uint8_t>(first, first + data.size())});
    return status();
  }

  Result<void> add_metadata(std::string_view name, const mcap::StringMap& values) override {
    send_encoded(Kind::add_metadata, trace_call::AddMetadata{std::string(name), trace_call::pairs_of(values)});
    return status();
  }

  void add_metadata_at_failure(std::string_view name, const mcap::StringMap& values) override {
    send_encoded(Kind::add_at_failure, trace_call::AddMetadata{std::string(name), trace_call::pairs_of(values)});
  }

  void set_pending(bool pending) override {
    if (pending) send({.kind = Kind::begin_pending});
    pending_ = pending;
  }

  Result<void> flush() override { return ask(Kind::flush); }
  Result<void> close() override {
    if (!closed_) {
      Result<void> result = ask(Kind::close);
      closed_ = std::move(result);
    }
    return *closed_;
  }
  int descriptor() const override { return -1; }
  bool is_changed_by_others() const override { return changed_by_others_; }
  std::uint64_t deadline() const override { return deadline_; }

 private:
  /// After a message: waits for the parent if the parent has to wait for the file, so that a kill of both processes
  /// loses no more than a kill of one process that writes its recording itself.
  Result<void> status(std::uint64_t log_time) {
    constexpr std::uint64_t first_look = 100'000'000;  // [ns]
    if (deadline_ == no_deadline) deadline_ = log_time + first_look;
    return log_time >= deadline_ ? ask(Kind::status) : status();
  }

  /// A failure of an earlier call: the parent has counted one that this process has not asked about.
  Result<void> status() {
    if (!to_parent || to_parent->failures() == seen_failures_) [[likely]]
      return {};
    seen_failures_ = to_parent->failures();
    return ask(Kind::status);
  }

  void send(Head head, Bytes rest = {}) {
    REHEARSE_ASSERT(!closed_ || head.kind == Kind::drop || head.kind == Kind::abandon,
                    "nothing is written to a closed trace");
    const std::scoped_lock lock(mutex_);
    head.trace = trace_;
    if (to_parent) to_parent->send({bytes_of(head), rest});
  }

  template <class Call>
  void send_encoded(Kind kind, const Call& call) {
    cdr_.reset();
    msg::encode(call, cdr_);
    send({.kind = kind}, cdr_.bytes());
  }

  template <class... Call>
  Result<void> ask(Kind kind, const Call&... call) {
    cdr_.reset();
    (msg::encode(call, cdr_), ...);
    const std::scoped_lock lock(mutex_);
    if (!to_parent) return error("a process that a controller forked doesn't write its recording");
    const Head head{.kind = kind, .trace = trace_};
    CdrReader reader(to_parent->ask({bytes_of(head), cdr_.bytes()}));
    trace_call::Answer answer;
    if (!msg::decode(reader, answer)) return error("the supervisor's answer about the trace can't be read");
    changed_by_others_ = answer.changed_by_others;
    deadline_ = answer.deadline;
    return result_of(std::move(answer));
  }

  static inline std::mutex mutex_;  // of to_parent
  const std::uint32_t trace_;
  std::uint32_t seen_failures_ = 0;
  bool changed_by_others_ = false;
  std::optional<Result<void>> closed_;  // result of the first close()
  static constexpr std::uint64_t no_deadline = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t deadline_ = no_deadline;  // of the parent's Writer [ns]
  bool pending_ = false;                  // the present messages are
  mcap::Definitions definitions_;
  CdrWriter cdr_;
};

}  // namespace

void send_recordings_through(Ring& ring) {
  to_parent.emplace(ring);
  to_parent->set_hidden_from_forks(true);
  pthread_atfork(nullptr, nullptr, [] {
    if (!shares_with_forks) to_parent.reset();
  });
}

/// The Writers of a fork have other numbers than those of this process and of earlier forks.
void share_recordings_with_forks(bool shared) {
  constexpr std::uint32_t numbers = 0x1'0000;  // of a process
  if (!to_parent) return;
  shares_with_forks = shared;
  to_parent->set_hidden_from_forks(!shared);
  if (shared) traces = (traces / numbers + 1) * numbers;
}

Result<RecordingWriter> create_recording(const std::filesystem::path& file) {
  if (!to_parent) {
    auto own = REHEARSE_TRY(mcap::Writer::create(file, trace_call::form_of_recordings()));
    return RecordingWriter{std::move(own)};
  }
  auto remote = std::make_unique<RemoteWriter>();
  REHEARSE_TRY(remote->create(file));
  SupervisedWriter* const supervised = remote.get();
  return RecordingWriter{std::move(remote), supervised};
}

}  // namespace rehearse
