#include "served_recording.h"

#include <rehearse/mcap.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "base/clock.h"
#include "served_content.h"
#include "viewer_server.h"

namespace rehearse {

using viewer_protocol::PlaybackStatus;

namespace {

constexpr std::chrono::milliseconds step_time{5};
constexpr std::size_t most_a_step = std::size_t{4} << 20;  // of messages [bytes]
constexpr std::uint64_t look_back = 1'000'000'000;         // for the last messages before a moment [ns]
constexpr std::uint64_t time_period = 20'000'000;          // of messages with the time, in wall time [ns]

std::uint64_t wall_time() {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
          .count());
}

/// A message that outlives its place in the file.
struct Kept {
  mcap::Message message;
  std::vector<std::byte> data;
};

}  // namespace

struct ServedRecording::Impl {
  Impl(std::unique_ptr<mcap::Reader> opened, const ServeOptions& all_options)
      : reader(std::move(opened)), options(all_options), content(*reader), speed(all_options.speed) {}

  std::unique_ptr<mcap::Reader> reader;
  ServeOptions options;
  ServedContent content;
  std::unique_ptr<ViewerServer> server;
  std::uint64_t begin = 0, end = 0;  // of the messages [ns]

  PlaybackStatus status = PlaybackStatus::playing;
  float speed;
  std::uint64_t now = 0;                          // messages up to here are sent [ns]
  std::uint64_t wall = 0;                         // wall time of the last step [ns]
  bool fresh = true;                              // the messages of the first moment aren't sent either
  double fraction = 0.0;                          // of a nanosecond that `now` lacks
  std::uint64_t told_at = 0;                      // wall time of the last message with the time [ns]
  std::optional<mcap::OrderedMessages> messages;  // after `now`; none: to be opened
  const mcap::Message* next = nullptr;            // of them, not sent yet
  std::uint64_t version = 0;                      // of the wanted channels that `messages` has

  bool find_range();
  void answer(const ViewerServer::Asked& asked);
  void seek(std::uint64_t time);
  void send_latest(const std::vector<std::uint16_t>& channels, std::optional<ViewerServer::Client> client);
  void play();
  void tell_state(const std::string& id = "") { server->publish_state(status, now, speed, id); }
};

/// Finds the times of the first and the last message; false: there is none.
bool ServedRecording::Impl::find_range() {
  if (const auto& statistics = reader->statistics(); statistics && statistics->message_count > 0) {
    begin = statistics->message_start_time;
    end = statistics->message_end_time;
    return begin <= end;
  }
  bool any = false;
  static_cast<void>(reader->for_each_message([&](const mcap::Message& message) {
    begin = any ? std::min(begin, message.log_time) : message.log_time;
    end = any ? std::max(end, message.log_time) : message.log_time;
    return any = true;
  }));
  return any;
}

/// Sends the last message of each channel that isn't after `now`, if it is not much older.
void ServedRecording::Impl::send_latest(const std::vector<std::uint16_t>& channels,
                                        std::optional<ViewerServer::Client> client) {
  if (channels.empty()) return;
  const std::uint64_t from = std::max(begin, now > look_back ? now - look_back : 0);
  std::map<std::uint16_t, Kept> latest;
  mcap::OrderedMessages before(*reader, channels, from);
  while (const mcap::Message* message = before.next()) {
    if (message->log_time > now) break;
    Kept& kept = latest[message->channel->id];
    kept.message = *message;
    kept.data.assign(message->data.begin(), message->data.end());
  }
  for (auto& [id, kept] : latest) {
    kept.message.data = kept.data;
    content.publish(kept.message, client);
  }
}

void ServedRecording::Impl::seek(std::uint64_t time) {
  now = std::clamp(time, begin, end);
  fresh = false;
  fraction = 0.0;
  messages.reset();
  if (status == PlaybackStatus::ended) status = PlaybackStatus::paused;
  server->publish_time(now);
  send_latest(content.wanted(), std::nullopt);
}

void ServedRecording::Impl::answer(const ViewerServer::Asked& asked) {
  if (asked.first_came ||
      (asked.came && status == PlaybackStatus::ended)) {  // a viewer sees the run from its beginning
    now = begin;
    fresh = true;
    fraction = 0.0;
    messages.reset();
    status = PlaybackStatus::playing;
    tell_state();
  }
  std::optional<std::uint64_t> sought;  // the last of several alone
  for (const viewer_protocol::Playback& request : asked.playback) {
    speed = request.speed;
    if (request.seek) sought = request.seek;
  }
  if (sought) seek(*sought);
  for (const viewer_protocol::Playback& request : asked.playback) {
    if (request.plays && status == PlaybackStatus::ended) seek(begin);
    status = request.plays                     ? PlaybackStatus::playing
             : status == PlaybackStatus::ended ? PlaybackStatus::ended
                                               : PlaybackStatus::paused;
    tell_state(request.id);
  }
  for (const auto& [client, channels] : asked.subscribed) {
    if (sought || (fresh && now == begin)) break;  // they have got them, or will get them
    std::set<std::uint16_t> sources;
    for (const std::uint32_t channel : channels) sources.insert(content.source_of(channel));
    send_latest({sources.begin(), sources.end()}, client);
  }
}

/// Sends the messages up to the moment that playback has reached. What a step has no time for delays playback.
void ServedRecording::Impl::play() {
  const std::uint64_t time = wall_time();
  const double passed = static_cast<double>(time - std::exchange(wall, time)) * static_cast<double>(speed) + fraction;
  if (status != PlaybackStatus::playing || !server->wants_any()) return;
  const auto whole = static_cast<std::uint64_t>(std::min(passed, 1e18));
  fraction = passed - static_cast<double>(whole);
  std::uint64_t target = std::min(end, now + whole);
  if (!messages || version != server->version_of_wanted()) {
    version = server->version_of_wanted();
    messages.reset();
    next = nullptr;
    if (const auto wanted = content.wanted(); !wanted.empty()) {
      messages.emplace(*reader, wanted, fresh && now == begin ? begin : now + 1);
      next = messages->next();
    }
  }
  std::size_t sent = 0;
  while (next && next->log_time <= target) {
    if (sent > most_a_step) {
      target = std::max(now, next->log_time - 1);
      break;
    }
    sent += next->data.size();
    content.publish(*next);
    next = messages->next();
  }
  now = target;
  if (time - told_at >= time_period || now == end) {
    told_at = time;
    server->publish_time(now);
    tell_state();
  }
  if (now < end) return;
  if (options.loops) {
    seek(begin);
    status = PlaybackStatus::playing;
  } else {
    status = PlaybackStatus::ended;
  }
  tell_state();
}

ServedRecording::ServedRecording(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

ServedRecording::~ServedRecording() = default;

Result<std::unique_ptr<ServedRecording>> ServedRecording::open(const std::filesystem::path& file,
                                                               const ServeOptions& options) {
  mcap::ReaderOptions quick;
  quick.opening = mcap::Opening::by_summary;
  auto impl = std::make_unique<Impl>(REHEARSE_TRY(mcap::Reader::open(file, quick)), options);
  if (!impl->find_range()) return error_in(file.string(), "there is no message to serve");
  ViewerServer::Content content = impl->content.summary();
  content.info.range = {impl->begin, impl->end};
  impl->server = REHEARSE_TRY(ViewerServer::listen({options.port, options.origins, options.tell}, std::move(content)));
  impl->content.offer(*impl->server, impl->begin);
  impl->now = impl->begin;
  impl->wall = wall_time();
  return std::unique_ptr<ServedRecording>(new ServedRecording(std::move(impl)));
}

std::string ServedRecording::address() const { return impl_->server->address(); }

std::string ServedRecording::link() const { return impl_->server->link(); }

double ServedRecording::duration() const { return seconds_of(static_cast<std::int64_t>(impl_->end - impl_->begin)); }

std::size_t ServedRecording::topics() const { return impl_->content.topics(); }

Diagnostics ServedRecording::remarks() const {
  Diagnostics all = impl_->content.remarks();
  all.insert(all.end(), impl_->reader->damage().begin(), impl_->reader->damage().end());
  return all;
}

void ServedRecording::step() {
  impl_->server->run_for(step_time);
  impl_->answer(impl_->server->take_asked());
  impl_->play();
}

void ServedRecording::stop() { impl_->server->stop(); }

}  // namespace rehearse
