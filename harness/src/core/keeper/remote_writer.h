// The recordings of a process that has a supervisor are written by that supervisor, its parent.
//
// Controllers share the memory, the locks and the descriptors of the process that runs them. A recording that another
// process writes is out of their reach, and contains everything that was sent before a failure.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/mcap.h>

#include <filesystem>
#include <memory>

namespace rehearse {

struct Ring;

/// From now on create_recording() sends recordings to the parent. Must be called in the child, before there are
/// threads.
void send_recordings_through(Ring& ring);

/// True: the next fork can send recordings, too, while this process sends none. False: forks can't, as before.
void share_recordings_with_forks(bool shared);

/// A Writer whose messages a supervisor writes, and what only a supervisor can do.
class SupervisedWriter : public mcap::Writer {
 public:
  /// While true, messages are pending: the supervisor writes them only if the process ends before the next message on
  /// /tick. They replace those that were pending before.
  virtual void set_pending(bool pending) = 0;

  /// Metadata that the supervisor adds to this recording if the process ends without closing it.
  virtual void add_metadata_at_failure(std::string_view name, const mcap::StringMap& values) = 0;
};

struct RecordingWriter {
  std::unique_ptr<mcap::Writer> writer;
  SupervisedWriter* supervised = nullptr;  // the same Writer; null: this process writes the recording itself
};

/// Creates a recording, as mcap::Writer::create() does. A supervisor writes it if there is one, else this process.
Result<RecordingWriter> create_recording(const std::filesystem::path& file);

/// Messages that are written in its lifetime are pending.
class PendingMessages {
 public:
  explicit PendingMessages(SupervisedWriter& writer) : writer_(writer) { writer_.set_pending(true); }
  ~PendingMessages() { writer_.set_pending(false); }
  PendingMessages(const PendingMessages&) = delete;
  PendingMessages& operator=(const PendingMessages&) = delete;

 private:
  SupervisedWriter& writer_;
};

}  // namespace rehearse
