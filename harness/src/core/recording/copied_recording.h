// CopiedRecording: copies parts of a different recording into one that is being written, for a run that begins with it.
#pragma once

#include <rehearse/io.h>
#include <rehearse/mcap.h>

#include <cstdint>
#include <string>
#include <vector>

#include "recorder.h"

namespace rehearse {

class CopiedRecording {
 public:
  /// The recorder must have its channels, and must outlive this.
  explicit CopiedRecording(Recorder& into) : recorder_(*into.impl_) {}

  /// Copies the bytes of a message to a topic. A missing topic is added like the topic of the other recording.
  Result<void> copy(const mcap::Message& message, const mcap::Schema& schema, const std::string& topic);
  /// True if the channels so far are the first of the other recording, so that its chunks can be copied.
  bool begins_like(const mcap::Reader& other) const;
  /// Copies a chunk of the other recording, which begins_like() this one. Its missing topics are added. Pictures in it
  /// must be passed to count_pictures().
  Result<void> copy_chunk(const mcap::StoredChunk& chunk, const mcap::Reader& other);
  /// Counts the message in the recorder's size() if it contains a picture.
  void count_pictures(const mcap::Message& message, const mcap::Schema& schema);

  // Write readings that differ from the other recording, instead of copies of its messages.
  Result<void> write_measured_joints(std::int64_t tick, int body, const std::vector<JointReading>& joints);
  Result<void> write_reading(std::int64_t tick, int body, int device, const DeviceReading& reading);
  Result<void> write_joystick(std::int64_t tick, const JoystickReading& reading);

 private:
  Recorder::Impl& recorder_;
};

}  // namespace rehearse
