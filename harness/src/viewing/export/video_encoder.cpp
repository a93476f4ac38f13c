#include "video_encoder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>
#include <vector>

#include "base/replaceable.h"
#include "export_files.h"

extern char** environ;

namespace rehearse {
namespace {

/// A kind of video: the file's extension, the first bytes of such files, and ffmpeg's options.
struct VideoKind {
  std::string_view extension;
  std::size_t magic_at = 0;
  std::string_view magic;
  std::vector<std::string> arguments;
};

const std::vector<VideoKind>& video_kinds() {
  // Most players support 4:2:0 only, which needs even widths and heights.
  static const std::vector<std::string> film{"-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"};
  static const std::vector<VideoKind> kinds{
      {".mp4", 4, "ftyp", film},
      {".mkv", 0, "\x1a\x45\xdf\xa3", film},
      {".webm", 0, "\x1a\x45\xdf\xa3", film},
      {".gif", 0, "GIF8", {"-vf", "split[a][b];[a]palettegen[p];[b][p]paletteuse", "-loop", "0"}},
      {".apng", 0, "\x89PNG", {"-plays", "0"}},
      {".webp", 0, "RIFF", {"-loop", "0"}}};
  return kinds;
}

const VideoKind* kind_of(const std::filesystem::path& file) {
  for (const VideoKind& kind : video_kinds())
    if (file.extension() == kind.extension) return &kind;
  return nullptr;
}

}  // namespace

Result<void> VideoEncoder::check_output(const std::filesystem::path& file) {
  const VideoKind* kind = kind_of(file);
  if (kind == nullptr) {
    return error(fmt::format("'{}' is no kind of video", file.extension().string()),
                 ".mp4, .mkv, .webm, .gif, .apng or .webp");
  }
  REHEARSE_TRY(check_replaceable(file, "", "video"));
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored) || std::filesystem::file_size(file, ignored) == 0) return {};
  std::string begin(kind->magic_at + kind->magic.size(), '\0');
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  const ssize_t got = descriptor < 0 ? -1 : ::read(descriptor, begin.data(), begin.size());
  if (descriptor >= 0) ::close(descriptor);
  if (got == static_cast<ssize_t>(begin.size()) && begin.substr(kind->magic_at) == kind->magic) return {};
  return error(fmt::format("won't replace {}: it exists and is no {} file", file.string(), kind->extension),
               "name another file, or remove it first");
}

Result<std::unique_ptr<VideoEncoder>> VideoEncoder::begin(const std::filesystem::path& file, std::string_view extension,
                                                          double rate) {
  // A socket, because a write without a reader can return an error there, instead of raising a signal.
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    return error(fmt::format("can't make a pipe: {}", std::strerror(errno)));
  const std::string name = std::filesystem::absolute(file).string();  // an absolute path never begins with -
  std::vector<std::string> words{"ffmpeg",
                                 "-hide_banner",
                                 "-loglevel",
                                 "error",
                                 "-y",
                                 "-f",
                                 "image2pipe",
                                 "-framerate",
                                 fmt::format("{:.6f}", rate),
                                 "-c:v",
                                 extension == "png" ? "png" : "mjpeg",
                                 "-i",
                                 "pipe:0"};
  const std::vector<std::string>& more = kind_of(file)->arguments;
  words.insert(words.end(), more.begin(), more.end());
  words.push_back("file:" + name);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  std::unique_ptr<VideoEncoder> encoder(new VideoEncoder());
  const int failed = ::posix_spawnp(&encoder->process_, "ffmpeg", &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (failed != 0) {
    ::close(ends[0]);
    encoder->process_ = -1;
    return error(fmt::format("can't start ffmpeg: {}", std::strerror(failed)), "apt-get install ffmpeg");
  }
  encoder->file_ = file;
  encoder->pipe_ = ends[0];
  return encoder;
}

VideoEncoder::~VideoEncoder() {
  if (process_ < 0) return;
  wait();
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

Result<void> VideoEncoder::put(std::span<const std::uint8_t> picture) {
  while (!picture.empty()) {
    const ssize_t sent = ::send(pipe_, picture.data(), picture.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) return error("ffmpeg has stopped before the last picture");
    picture = picture.subspan(static_cast<std::size_t>(sent));
  }
  return {};
}

Result<void> VideoEncoder::end() {
  const int status = wait();
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
  return error("ffmpeg could not make the video");
}

int VideoEncoder::wait() {
  ::close(pipe_);
  int status = -1;
  while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  return status;
}

}  // namespace rehearse
