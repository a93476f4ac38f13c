// ChunkCopy: writes the beginning of a recording into another one, whose controllers repeat it. Whole chunks are copied
// as they are stored.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/mcap.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/recording/copied_recording.h"

namespace rehearse {

class ChunkCopy {
 public:
  /// The messages before `end` [ns] will be copied. The recorder must have its channels. Both must outlive this.
  ChunkCopy(mcap::Reader& source, Recorder& recorder, std::uint64_t end);

  /// False: the source is damaged, or its channels aren't those of the recorder.
  bool is_possible() const { return is_possible_; }
  /// Must be called with the messages of the source in their order; it needs only one channel of each tick, and all
  /// pictures. Copies the whole chunks before the message.
  Result<void> take(const mcap::Message& message);
  /// Copies the remaining messages before the end.
  Result<void> finish();
  /// The channels of pictures.
  const std::vector<std::uint16_t>& picture_channels() const { return picture_channels_; }
  /// The number of chunks that were copied as they are stored.
  std::size_t chunks() const { return next_; }

 private:
  bool is_whole(const mcap::Message& message) const;
  Result<void> copy_next();

  mcap::Reader& source_;
  CopiedRecording copy_;
  const std::uint64_t end_;  // [ns]
  const bool is_possible_;
  std::vector<mcap::Chunk> whole_;  // chunks that end before end_, in file order
  std::size_t next_ = 0;            // index in whole_
  std::vector<std::uint16_t> picture_channels_;
};

}  // namespace rehearse
