// StepSession: executes the commands of `rehearse step`. It stores the current tick in the recording.
#pragma once

#include "viewing/stepping/tick_view.h"

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse::tool {

class StepSession {
 public:
  /// `command_line`: the arguments that name the trace and its controllers. `interrupted`: returns true to end a long
  /// search.
  StepSession(SteppedTrace& trace, std::string command_line, std::function<bool()> interrupted);

  enum class Answer {
    done,
    not_understood,  // or not possible; stderr contains the reason
    quit,
  };
  /// Executes a line. An empty line repeats the last one.
  Answer answer(std::string_view line);
  /// The line that is printed after each move: the current tick, its events, the watched series.
  std::string where();
  void go_to(std::int64_t tick);
  /// A plot of the first difference in this tick; prints nothing if there is none, or it isn't one of numbers.
  void plot_difference();
  /// Three lines: what the keys do.
  static std::string keys_text();
  std::int64_t tick() const { return tick_; }

  /// Possible words after `before` in a line that begin with `word`: for completion.
  std::vector<std::string> candidates(std::string_view before, std::string_view word) const;

 private:
  using Words = std::string_view;
  struct Command {
    std::string_view name, letter, arguments, help;
    Answer (StepSession::*function)(Words rest);
    bool takes_series = false;
  };
  static const std::vector<Command>& commands();
  const Command* find(std::string_view word) const;

  Answer next(Words rest);
  Answer back(Words rest);
  Answer go_to_place(Words rest);
  Answer until(Words rest);
  Answer go_on(Words rest);
  Answer watch(Words rest);
  Answer unwatch(Words rest);
  Answer print_value(Words rest);
  Answer info(Words rest);
  Answer inputs(Words rest);
  Answer commanded(Words rest);
  Answer messages(Words rest);
  Answer contacts(Words rest);
  Answer threads(Words rest);
  Answer differences(Words rest);
  Answer plot(Words rest);
  Answer frame(Words rest);
  Answer gdb_hint(Words rest);
  Answer help(Words rest);
  Answer quit(Words rest);

  Answer refuse(const Diagnostic& diagnostic) const;
  Answer move(std::int64_t by);
  Answer search(Words text, Direction direction);
  Answer to_happening(Direction direction);
  bool arrive(std::int64_t tick);

  SteppedTrace& trace_;
  const std::string command_line_;
  const std::function<bool()> interrupted_;
  std::int64_t tick_;
  std::vector<std::size_t> watched_;  // series
  std::string last_line_;
};

}  // namespace rehearse::tool
