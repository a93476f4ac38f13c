#include "served_recording.h"

#include <rehearse/mcap.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "base/clock.h"
#include "growing_file.h"
#include "served_content.h"
#include "viewer_server.h"

namespace rehearse {

using viewer_protocol::PlaybackStatus;

namespace {

constexpr std::chrono::milliseconds step_time{5};
constexpr std::size_t most_a_step = std::size_t{4} << 20;  // of messages [bytes]
constexpr std::uint64_t look_back = 1'000'000'000;         // for the last messages before a moment [ns]
constexpr double follow_rate = 2.0;                        // of a backlog, so much is sent in a second [1/s]
constexpr std::uint64_t chunk_span = 1'000'000'000;        // of recordings: mcap::WriterOptions [ns]
constexpr std::uint64_t look_period = 100'000'000;         // of looks at a recording that is followed, wall time [ns]
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
  Impl(const std::filesystem::path& named, const ServeOptions& all_options)
      : file(named), growing(named), options(all_options), speed(all_options.speed) {}

  std::filesystem::path file;
  GrowingFile growing;  // a recording that is followed
  ServeOptions options;
  std::unique_ptr<mcap::Reader> reader;     // null: nobody has written the recording yet
  std::unique_ptr<mcap::Reader> described;  // of `content`, if it isn't the same
  std::unique_ptr<ServedContent> content;
  std::unique_ptr<ViewerServer> server;
  std::uint64_t begin = 0, end = 0;  // of the messages; of those that are all there, if more are being written [ns]
  std::uint64_t known_end = 0;       // of the messages that were there a look ago [ns]
  std::uint64_t looked_at = 0;       // wall time of the last look at a recording that is followed [ns]

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

  void follow();
  void play_on(std::uint64_t target);
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
    content->publish(kept.message, client);
  }
}

void ServedRecording::Impl::seek(std::uint64_t time) {
  now = std::clamp(time, begin, end);
  fresh = false;
  fraction = 0.0;
  messages.reset();
  if (status == PlaybackStatus::ended) status = PlaybackStatus::paused;
  server->publish_time(now);
  send_latest(content->wanted(), std::nullopt);
}

void ServedRecording::Impl::answer(const ViewerServer::Asked& asked) {
  if (!content) return;
  if (options.follows) {
    for (const auto& [client, channels] : asked.subscribed) {
      std::set<std::uint16_t> sources;
      for (const std::uint32_t channel : channels) sources.insert(content->source_of(channel));
      if (!fresh) send_latest({sources.begin(), sources.end()}, client);
    }
    return;
  }
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
    if (sought || fresh) break;  // they have got them, or will get them
    std::set<std::uint16_t> sources;
    for (const std::uint32_t channel : channels) sources.insert(content->source_of(channel));
    send_latest({sources.begin(), sources.end()}, client);
  }
}

/// Sends the messages after `now` up to the moment `target` [ns]. What a step has no time for delays playback.
void ServedRecording::Impl::play_on(std::uint64_t target) {
  if (!messages || version != server->version_of_wanted()) {
    version = server->version_of_wanted();
    messages.reset();
    next = nullptr;
    if (const auto wanted = content->wanted(); !wanted.empty()) {
      messages.emplace(*reader, wanted, fresh ? begin : now + 1);
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
    content->publish(*next);
    next = messages->next();
  }
  now = target;
  if (messages) fresh = false;
}

void ServedRecording::Impl::play() {
  const std::uint64_t time = wall_time();
  const double passed = static_cast<double>(time - std::exchange(wall, time));  // [ns]
  if (!reader || status != PlaybackStatus::playing) return;
  if (!server->wants_any()) {
    if (options.follows && !server->has_clients() && end > now) {  // who comes later sees the run as it is then
      now = end;
      fresh = false;
    }
    return;
  }
  const double backlog = static_cast<double>(end - now);
  const double step =
      (options.follows ? std::max(passed, passed / 1e9 * follow_rate * backlog) : passed * static_cast<double>(speed)) +
      fraction;
  const auto whole = static_cast<std::uint64_t>(std::min(step, backlog));
  fraction = std::min(step - static_cast<double>(whole), 1.0);
  play_on(now + whole);
  if (time - told_at >= time_period || now == end) {
    told_at = time;
    server->publish_time(now);
    if (!options.follows) tell_state();
  }
  if (now < end) return;
  if (options.follows) {
    if (growing.is_finished())
      server->publish_status(viewer_protocol::Level::info, "the run has ended: `rehearse serve` plays its recording");
    return;
  }
  if (options.loops) {
    seek(begin);
    status = PlaybackStatus::playing;
  } else {
    status = PlaybackStatus::ended;
  }
  tell_state();
}

/// Takes in what a different process has written since the last look.
void ServedRecording::Impl::follow() {
  const std::uint64_t time = wall_time();
  if (!options.follows || time - looked_at < look_period || growing.is_finished()) return;
  looked_at = time;
  if (!growing.look()) return;
  mcap::ReaderOptions quick;
  quick.opening = mcap::Opening::by_summary;
  auto opened = mcap::Reader::open(*growing.opened(), quick);
  if (!opened || (*opened)->chunks().empty()) return;
  std::uint64_t first = UINT64_MAX, last = 0;  // of the messages that are there [ns]
  for (const mcap::Chunk& chunk : (*opened)->chunks()) {
    first = std::min(first, chunk.start_time);
    last = std::max(last, chunk.end_time);
  }
  // A chunk holds a second of the run at most, and those of other channels may be written a moment later.
  const std::uint64_t complete = std::exchange(known_end, last);
  const auto complete_at = [&](std::uint64_t time) { return growing.is_finished() || complete >= time + chunk_span; };
  if (!complete_at(first)) return;
  messages.reset();
  next = nullptr;
  if (!reader) now = begin = first;
  if (!described) described = std::move(reader);
  reader = *std::move(opened);
  end = growing.is_finished() ? last : complete - chunk_span;
  if (!content || reader->channels().size() != content->channels()) {
    content = std::make_unique<ServedContent>(*reader);
    described.reset();
    server->set_parameters(content->summary().parameters);
    content->offer(*server, begin);
  }
}

ServedRecording::ServedRecording(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

ServedRecording::~ServedRecording() = default;

Result<std::unique_ptr<ServedRecording>> ServedRecording::open(const std::filesystem::path& file,
                                                               const ServeOptions& options) {
  auto impl = std::make_unique<Impl>(file, options);
  ViewerServer::Content content;
  if (!options.follows) {
    mcap::ReaderOptions quick;
    quick.opening = mcap::Opening::by_summary;
    impl->reader = REHEARSE_TRY(mcap::Reader::open(file, quick));
    if (!impl->find_range()) return error_in(file.string(), "there is no message to serve");
    impl->content = std::make_unique<ServedContent>(*impl->reader);
    content = impl->content->summary();
    content.info.range = {impl->begin, impl->end};
  }
  content.info.name = "rehearse " + file.string();
  impl->server = REHEARSE_TRY(ViewerServer::listen({options.port, options.origins, options.tell}, std::move(content)));
  if (impl->content) impl->content->offer(*impl->server, impl->begin);
  impl->now = impl->begin;
  impl->wall = wall_time();
  return std::unique_ptr<ServedRecording>(new ServedRecording(std::move(impl)));
}

std::string ServedRecording::address() const { return impl_->server->address(); }

std::string ServedRecording::link() const { return impl_->server->link(); }

double ServedRecording::duration() const { return seconds_of(static_cast<std::int64_t>(impl_->end - impl_->begin)); }

std::size_t ServedRecording::topics() const { return impl_->content ? impl_->content->topics() : 0; }

Diagnostics ServedRecording::remarks() const {
  if (!impl_->content) return {};
  Diagnostics all = impl_->content->remarks();
  all.insert(all.end(), impl_->reader->damage().begin(), impl_->reader->damage().end());
  return all;
}

void ServedRecording::step() {
  impl_->server->run_for(step_time);
  impl_->follow();
  impl_->answer(impl_->server->take_asked());
  impl_->play();
}

bool ServedRecording::is_over() const {
  const bool is_sent = impl_->now == impl_->end || !impl_->server->wants_any();
  return impl_->options.follows && impl_->growing.is_finished() && is_sent;
}

void ServedRecording::stop() { impl_->server->stop(); }

}  // namespace rehearse
