#include "terminal.h"

#include <termios.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstdio>

namespace rehearse::tool {
namespace {

constexpr char control_c = 3, control_d = 4;

/// No lines, no echo and no signals from keys, as long as it lives.
class SingleKeys {
 public:
  SingleKeys() : changed_(tcgetattr(STDIN_FILENO, &before_) == 0) {
    if (!changed_) return;
    termios single = before_;
    single.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO | ISIG);
    single.c_cc[VMIN] = 1;
    single.c_cc[VTIME] = 0;
    tcsetattr(STDIN_FILENO, TCSAFLUSH, &single);  // what was typed before the question doesn't answer it
  }
  ~SingleKeys() {
    if (changed_) tcsetattr(STDIN_FILENO, TCSAFLUSH, &before_);
  }
  SingleKeys(const SingleKeys&) = delete;
  SingleKeys& operator=(const SingleKeys&) = delete;

 private:
  termios before_{};
  bool changed_;
};

}  // namespace

bool somebody_is_there() { return isatty(STDIN_FILENO) == 1 && isatty(STDOUT_FILENO) == 1; }

char read_key(std::string_view keys) {
  std::fflush(stdout);
  const SingleKeys mode;
  for (;;) {
    char key = '\0';
    const ssize_t got = ::read(STDIN_FILENO, &key, 1);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0 || key == control_c || key == control_d) return '\0';
    key = static_cast<char>(std::tolower(static_cast<unsigned char>(key)));
    if (keys.find(key) != std::string_view::npos) return key;
  }
}

}  // namespace rehearse::tool
