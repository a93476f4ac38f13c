#include "terminal.h"

#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstdio>
#include <optional>

namespace rehearse::tool {
namespace {

constexpr char control_c = 3, control_d = 4, escape = 27;
constexpr int escape_patience = 50;  // [ms]: bytes that follow an escape within this time belong to the same key

/// During its lifetime the terminal has no line mode, no echo and no signals from keys.
class SingleKeys {
 public:
  SingleKeys() : changed_(tcgetattr(STDIN_FILENO, &before_) == 0) {
    if (!changed_) return;
    termios single = before_;
    single.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO | ISIG);
    single.c_cc[VMIN] = 1;
    single.c_cc[VTIME] = 0;
    tcsetattr(STDIN_FILENO, TCSAFLUSH, &single);  // discards keys that were pressed before the question
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

/// The next byte; nullopt at the end of the input.
std::optional<char> next_byte() {
  for (;;) {
    char byte = '\0';
    const ssize_t got = ::read(STDIN_FILENO, &byte, 1);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return std::nullopt;
    return byte;
  }
}

/// Reads the rest of the sequence of an arrow or function key (ESC [ ... letter), so that its letters are ignored.
void pass_over_sequence() {
  bool first = true;
  for (;;) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, 1, escape_patience) <= 0) return;  // the escape key itself
    const std::optional<char> byte = next_byte();
    const bool opens = first && (byte == '[' || byte == 'O');
    if (!byte || (!opens && *byte >= '@' && *byte <= '~')) return;
    first = false;
  }
}

}  // namespace

bool somebody_is_there() { return isatty(STDIN_FILENO) == 1 && isatty(STDOUT_FILENO) == 1; }

char read_key(std::string_view keys) {
  std::fflush(stdout);
  const SingleKeys mode;
  for (;;) {
    const std::optional<char> byte = next_byte();
    if (!byte || *byte == control_c || *byte == control_d) return '\0';
    if (*byte == escape) {
      pass_over_sequence();
      continue;
    }
    const char key = static_cast<char>(std::tolower(static_cast<unsigned char>(*byte)));
    if (keys.find(key) != std::string_view::npos) return key;
  }
}

}  // namespace rehearse::tool
