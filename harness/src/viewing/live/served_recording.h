// ServedRecording: a recording that viewers play, pause and search. It is read by its index, a chunk at a time.
// Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace rehearse {

struct ServeOptions {
  std::uint16_t port = 0;            // 0: any free port
  std::vector<std::string> origins;  // of pages that may connect, besides pages of this machine and Foxglove's
  float speed = 1.0F;                // at first, of playback
  bool loops = false;                // begins again at the end
  bool follows = false;              // the recording is, or will be, written by a different process
  std::function<void(const std::string&)> tell;  // gets a line for the terminal; never null
};

class ServedRecording {
 public:
  /// Opens the log and listens. A log of another program is served as it is; a recording of Rehearse in the form that
  /// viewers need, as export_for_viewer() writes it. Fails if it has no message, or the port is in use. A recording
  /// that is followed need not be there yet; viewers get all of its messages in order, a second of the run after the
  /// writer.
  static Result<std::unique_ptr<ServedRecording>> open(const std::filesystem::path& file, const ServeOptions& options);
  ~ServedRecording();
  ServedRecording(const ServedRecording&) = delete;
  ServedRecording& operator=(const ServedRecording&) = delete;

  std::string address() const;  // for viewers, as "ws://127.0.0.1:8765/?token=..."
  std::string link() const;     // the same, for Foxglove in a browser
  double duration() const;      // [s]
  std::size_t topics() const;   // number of topics
  Diagnostics remarks() const;  // bodies without a description, damage

  /// Serves for a few milliseconds.
  void step();
  /// A recording that is followed is complete, and viewers have it.
  bool is_over() const;
  /// Ends all connections.
  void stop();

 private:
  struct Impl;
  explicit ServedRecording(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rehearse
