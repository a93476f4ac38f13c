#include "reader_process.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>

namespace rehearse {

std::string text_of_child(const std::function<void(std::FILE*)>& print) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return {};
  const pid_t child = ::fork();
  if (child == 0) {
    if (std::FILE* const to = ::fdopen(ends[1], "w")) {
      print(to);
      std::fflush(to);
    }
    ::_exit(0);
  }
  ::close(ends[1]);
  std::string text;
  std::array<char, 4096> block{};
  for (ssize_t came = child < 0 ? 0 : 1; came != 0;) {
    came = ::read(ends[0], block.data(), block.size());
    if (came > 0) text.append(block.data(), static_cast<std::size_t>(came));
    if (came < 0 && errno != EINTR) break;
  }
  ::close(ends[0]);
  while (child > 0 && ::waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
  }
  return text;
}

}  // namespace rehearse
