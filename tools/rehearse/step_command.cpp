// rehearse step: goes through a recording tick by tick, at a terminal or by a script of commands on stdin.
#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>

#include "command.h"
#include "core/host/virtualised.h"
#include "line_editor.h"
#include "options.h"
#include "progress.h"
#include "replay_ticks.h"
#include "step_session.h"
#include "viewing/stepping/tick_view.h"

namespace rehearse::tool {
namespace {

struct StepSettings {
  std::string trace;
  TimeSpan span;
  SteppingOptions stepping;
};

std::string command_line(const StepSettings& settings) {
  std::string text = settings.trace;
  for (const auto& [name, library] : settings.stepping.libraries)
    text += fmt::format(" --controller {}={}", name, library);
  return text;
}

/// Runs until quit or the end of the input. After an invalid command a script continues, but ends with bad input.
Exit talk(SteppedTrace& trace, StepSession& session) {
  LineEditor editor("(step) ",
                    [&](std::string_view before, std::string_view word) { return session.candidates(before, word); });
  if (editor.is_interactive())
    fmt::print("{}: {} ticks{}\n", trace.file(), trace.last_tick() - trace.first_tick() + 1,
               trace.first_difference() == session.tick() ? "; this is the first difference" : "");
  fmt::print("{}\n", session.where());
  if (editor.is_interactive()) {
    session.plot_difference();
    fmt::print("{}", StepSession::keys_text());
  }
  bool understood = true;
  while (const auto line = editor.next()) {
    if (LineEditor::was_interrupted()) continue;
    if (!editor.is_interactive() && line->find_first_not_of(" \t\r") == std::string::npos) continue;
    const StepSession::Answer answer = session.answer(*line);
    if (answer == StepSession::Answer::quit) break;
    understood = understood && answer == StepSession::Answer::done;
  }
  return understood || editor.is_interactive() ? Exit::done : Exit::bad_input;
}

Exit run_step(StepSettings& settings) {
  if (const auto ready = virtualise_process_like(settings.trace); !ready) return refuse(ready.errors());
  InterposerWatch watch;
  if (is_interposed()) settings.stepping.watch = &watch;
  auto trace = [&] {
    Progress progress("replaying");
    settings.stepping.progress = [&](std::int64_t done, std::int64_t all) { progress.show(done, all); };
    return SteppedTrace::open(settings.trace, settings.stepping);
  }();
  if (!trace) return refuse(trace.errors());
  tell_remarks(**trace);
  const auto span = seconds_in(settings.span, settings.trace);
  if (!span) return refuse(span.errors());
  const double seconds = span->from.value_or(0.0);
  const std::int64_t first = (*trace)->first_difference().value_or((*trace)->tick_at(0.0));
  const std::int64_t from = span->from ? (*trace)->tick_at(seconds) : first;
  if (from > (*trace)->last_tick())
    return refuse(error(fmt::format("{} ends before {} s: its last tick is {} ({:.10g} s)", settings.trace, seconds,
                                    (*trace)->last_tick(), (*trace)->time_at((*trace)->last_tick()))));
  StepSession session(**trace, command_line(settings), LineEditor::was_interrupted);
  session.go_to(from);
  return talk(**trace, session);
}

std::function<Exit()> declare_step(CLI::App& options) {
  const auto settings = std::make_shared<StepSettings>();
  options.add_option("TRACE", settings->trace, "the recording")->required()->type_name("");
  add_time(options, "--from", "begin at this time (at the first difference, or at the beginning)",
           [=](mcap::TimeBound from) { settings->span.from = from; });
  add_host_options(options, settings->stepping);
  return [settings] { return run_step(*settings); };
}

}  // namespace

extern const Verb step_verb{"step",
                            "  rehearse step failed.mcap --from 3.0\n"
                            "  rehearse step failed.mcap --controller Walker=build/MyWalker.so\n"
                            "  printf 'goto 3.2s\\ninfo\\n' | rehearse step failed.mcap\n",
                            declare_step};

}  // namespace rehearse::tool
