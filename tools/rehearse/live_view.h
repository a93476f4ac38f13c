// LiveView: a process that serves a recording to viewers while this process writes it.
#pragma once

#include <rehearse/diagnostic.h>
#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <memory>

namespace rehearse::tool {

class LiveView {
 public:
  /// Starts `rehearse serve --follow`, waits until it listens, and prints its address on stderr. Must be called before
  /// there are threads. Fails if the port is in use, or the build has no wing `viewing`.
  static Result<std::unique_ptr<LiveView>> start(const std::filesystem::path& recording, std::uint16_t port);
  /// Viewers get the rest for two seconds at most; then the process is ended.
  ~LiveView();
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;

 private:
  explicit LiveView(pid_t process) : process_(process) {}
  const pid_t process_;
};

}  // namespace rehearse::tool
