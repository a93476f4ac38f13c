#include "chunk_copy.h"

#include <rehearse/messages.h>

#include <algorithm>

#include "recording_source.h"

namespace rehearse {

ChunkCopy::ChunkCopy(mcap::Reader& source, Recorder& recorder, std::uint64_t end)
    : source_(source),
      recorder_(recorder),
      end_(end),
      is_possible_(source.can_copy_chunks() && recorder.begins_like(source)) {
  for (const mcap::Chunk& chunk : source.chunks())
    if (chunk.end_time < end) whole_.push_back(chunk);
  for (const auto& [id, channel] : source.channels()) {
    const mcap::Schema* schema = source.schema_of(channel);
    if (schema && (schema->name == msg::CompressedImage::type_name || schema->name == msg::Image::type_name))
      picture_channels_.push_back(id);
  }
}

bool ChunkCopy::is_whole(const mcap::Message& message) const {
  const auto place = std::ranges::lower_bound(whole_, message.location.record, {}, &mcap::Chunk::offset);
  return place != whole_.end() && place->offset == message.location.record;
}

Result<void> ChunkCopy::take(const mcap::Message& message) {
  if (std::ranges::binary_search(picture_channels_, message.channel->id) && is_whole(message))
    recorder_.count_pictures(message, *source_.schema_of(*message.channel));
  while (next_ < whole_.size() && whole_[next_].end_time < message.log_time) REHEARSE_TRY(copy_next());
  return {};
}

Result<void> ChunkCopy::copy_next() {
  const auto stored = source_.stored_chunk(whole_[next_++]);
  if (!stored) return in_recording(source_, error("it was changed while it was read"));
  return recorder_.copy_chunk(*stored, source_);
}

Result<void> ChunkCopy::finish() {
  while (next_ < whole_.size()) REHEARSE_TRY(copy_next());
  if (!source_.can_copy_chunks()) return in_recording(source_, error("it was changed while it was read"));
  std::uint64_t begin = end_;
  for (const mcap::Chunk& chunk : source_.chunks())
    if (chunk.end_time >= end_) begin = std::min(begin, chunk.start_time);
  if (begin == end_) return {};
  mcap::OrderedMessages messages(source_, {}, begin);
  for (const mcap::Message* message; (message = messages.next()) && message->log_time < end_;)
    if (!is_whole(*message))
      if (auto copied = recorder_.copy(*message, *source_.schema_of(*message->channel), message->channel->topic);
          !copied)
        return copied;
  return messages.verdict();
}

}  // namespace rehearse
