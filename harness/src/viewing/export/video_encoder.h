// Encodes pictures as a video, by a process of ffmpeg. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <sys/types.h>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

namespace rehearse {

class VideoEncoder {
 public:
  /// Fails if the file's name has no ending of a video, or if a file of a different kind would be replaced.
  static Result<void> check_output(const std::filesystem::path& file);

  /// Starts ffmpeg. `extension`: the kind of the picture files, "png" or "jpg". `rate` [pictures per second].
  static Result<std::unique_ptr<VideoEncoder>> begin(const std::filesystem::path& file, std::string_view extension,
                                                     double rate);
  /// Removes the file if end() was not called.
  ~VideoEncoder();
  VideoEncoder(const VideoEncoder&) = delete;
  VideoEncoder& operator=(const VideoEncoder&) = delete;

  /// Adds the bytes of the next picture's file.
  Result<void> put(std::span<const std::uint8_t> picture);
  /// Waits until the video is written. Fails if ffmpeg fails; its messages are on stderr.
  Result<void> end();

 private:
  VideoEncoder() = default;
  int wait();

  std::filesystem::path file_;
  pid_t process_ = -1;
  int pipe_ = -1;  // stdin of ffmpeg
};

}  // namespace rehearse
