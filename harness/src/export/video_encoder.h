// Pictures into a video, by a process of ffmpeg's. Internal.
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
  /// That the file's name says a kind of video, and that nothing else would be replaced.
  static Result<void> check_output(const std::filesystem::path& file);

  /// Starts ffmpeg. `extension`: what kind of files the pictures are, "png" or "jpg". `rate` [pictures a second].
  static Result<std::unique_ptr<VideoEncoder>> begin(const std::filesystem::path& file, std::string_view extension,
                                                     double rate);
  /// If end() was not reached, no file stays.
  ~VideoEncoder();
  VideoEncoder(const VideoEncoder&) = delete;
  VideoEncoder& operator=(const VideoEncoder&) = delete;

  /// The bytes of the next picture's file.
  Result<void> put(std::span<const std::uint8_t> picture);
  /// Waits until the video is written. Fails if ffmpeg does; what it has to say is on stderr.
  Result<void> end();

 private:
  VideoEncoder() = default;
  int wait();

  std::filesystem::path file_;
  pid_t process_ = -1;
  int pipe_ = -1;  // its stdin
};

}  // namespace rehearse
