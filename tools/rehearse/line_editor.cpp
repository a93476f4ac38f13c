#include "line_editor.h"

#include <editline/readline.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>

#include "terminal.h"

namespace rehearse::tool {
namespace {

// Global variables, because libedit calls functions without a user argument.
LineEditor::Complete complete_word;
std::vector<std::string> candidates;
volatile std::sig_atomic_t interrupted = 0;

void on_interrupt(int) { interrupted = 1; }

/// The next candidate that begins with the word, in memory that libedit frees.
char* next_candidate(const char* word, int state) {
  static std::size_t next = 0;
  if (state == 0) next = 0;
  while (next < candidates.size()) {
    const std::string& candidate = candidates[next++];
    if (candidate.starts_with(word)) return strdup(candidate.c_str());
  }
  return nullptr;
}

char** complete_line(const char* word, int begin, int) {
  rl_attempted_completion_over = 1;  // no completion of file names
  candidates = complete_word(std::string_view(rl_line_buffer).substr(0, static_cast<std::size_t>(begin)), word);
  return rl_completion_matches(word, next_candidate);
}

/// During the lifetime of this object Ctrl-C is delivered only in read_key(). Otherwise a Ctrl-C immediately before the
/// wait for a key would be noticed only with the next key.
class InterruptsHeld {
 public:
  InterruptsHeld() {
    sigset_t held;
    sigemptyset(&held);
    sigaddset(&held, SIGINT);
    pthread_sigmask(SIG_BLOCK, &held, &before);
  }
  ~InterruptsHeld() { pthread_sigmask(SIG_SETMASK, &before, nullptr); }
  InterruptsHeld(const InterruptsHeld&) = delete;
  InterruptsHeld& operator=(const InterruptsHeld&) = delete;

  static inline sigset_t before;
};

/// Reads a character. Returns -1, which ends the line, at the end of the input and on Ctrl-C.
int read_key(FILE*) {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  while (ppoll(&input, 1, nullptr, &InterruptsHeld::before) < 0)
    if (interrupted || errno != EINTR) return -1;
  unsigned char key = 0;
  return read(STDIN_FILENO, &key, 1) == 1 ? key : -1;
}

/// System calls are interrupted by Ctrl-C and not restarted.
void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
}

}  // namespace

LineEditor::LineEditor(std::string prompt, Complete complete)
    : prompt_(std::move(prompt)), interactive_(somebody_is_there()) {
  if (!interactive_) return;
  complete_word = std::move(complete);
  static char name[] = "rehearse";
  static char breaks[] = " \t\n()!&|<>=,*+'\"";
  rl_readline_name = name;
  rl_basic_word_break_characters = breaks;
  rl_completer_word_break_characters = breaks;
  rl_attempted_completion_function = complete_line;
  rl_getc_function = read_key;
  using_history();
  stifle_history(1000);
  catch_interrupts();
}

LineEditor::~LineEditor() {
  if (!interactive_) return;
  complete_word = nullptr;
  std::signal(SIGINT, SIG_DFL);
}

bool LineEditor::was_interrupted() { return interrupted != 0; }

std::optional<std::string> LineEditor::next() {
  std::fflush(stdout);
  interrupted = 0;
  if (!interactive_) {
    std::string line;
    return std::getline(std::cin, line) ? std::optional(line) : std::nullopt;
  }
  char* line = nullptr;
  {
    const InterruptsHeld held;
    line = readline(prompt_.c_str());
    catch_interrupts();  // libedit has replaced the signal handlers
  }
  if (!line) {
    std::puts("");
    return interrupted ? std::optional<std::string>("") : std::nullopt;
  }
  std::string text = line;
  std::free(line);
  if (text.find_first_not_of(" \t") != std::string::npos) add_history(text.c_str());
  return text;
}

}  // namespace rehearse::tool
