// rehearse serve: plays a recording to viewers, which connect by Foxglove's WebSocket protocol.
#include <fmt/format.h>
#include <rehearse/golden.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "command.h"
#include "core/guard/interruption.h"
#include "options.h"
#include "output.h"
#include "viewing/live/served_recording.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

struct ServeSettings {
  std::string trace;
  ServeOptions options;
  bool ends_with_parent = false;
};

/// The file, or the golden of that name in this project.
fs::path file_of(const std::string& name) {
  std::error_code ignored;
  if (fs::exists(name, ignored)) return name;
  const auto folder = find_golden_folder("./");
  if (!folder) return name;
  const GoldenStore store(*folder);
  return store.has(name) ? store.trace_file(name) : fs::path(name);
}

Exit run_serve(ServeSettings& settings) {
  const pid_t parent = getppid();
  settings.options.tell = [](const std::string& line) { fmt::print(stderr, "{}\n", line); };
  const bool follows = settings.options.follows;  // its file need not be there yet
  const auto served =
      ServedRecording::open(follows ? fs::path(settings.trace) : file_of(settings.trace), settings.options);
  if (!served) return refuse(served.errors());
  ServedRecording& recording = **served;
  for (const Diagnostic& remark : recording.remarks()) fmt::print(stderr, "{}\n", to_string(remark));
  end_runs_on_signals();
  if (settings.options.follows)
    fmt::print("serving {} while it is written\n", settings.trace);
  else
    fmt::print("serving {}: {:g} s, {}; it plays when a viewer connects\n", settings.trace, recording.duration(),
               count_text(recording.topics(), "topic"));
  fmt::print("in a browser: {}\n", recording.link());
  fmt::print("in a viewer:  {}\n", recording.address());
  fmt::print("Ctrl-C ends it\n");
  std::fflush(stdout);
  const auto has_parent = [&] { return !settings.ends_with_parent || getppid() == parent; };
  while (interruption() == 0 && has_parent() && !recording.is_over()) recording.step();
  recording.stop();
  return Exit::done;
}

std::function<Exit()> declare_serve(CLI::App& options) {
  const auto settings = std::make_shared<ServeSettings>();
  options
      .add_option("TRACE", settings->trace,
                  "a recording, or any other log, as of export; or the name of a golden of this project")
      ->required()
      ->type_name("");
  settings->options.port = 8765;
  add_integer(options, "--port", "listen on this port of this machine; 0: on any free one (8765)", 0, 65535,
              [=](std::int64_t port) { settings->options.port = static_cast<std::uint16_t>(port); });
  add_number(options, "--speed", "speed of playback at first: 0.1 is a tenth of the run's (1)", 0.001, 1000.0,
             [=](double speed) { settings->options.speed = static_cast<float>(speed); });
  options.add_flag("--loop", settings->options.loops, "play again from the beginning at the end");
  options.add_flag("--follow", settings->options.follows,
                   "serve a recording that is being written, or will be, until it is complete");
  options.add_flag("--ends-with-parent", settings->ends_with_parent)->group("");  // of record --live
  options
      .add_option("--origin", settings->options.origins,
                  "pages of this address may connect as well, as https://viewer.example.com; repeatable")
      ->type_name("ORIGIN")
      ->allow_extra_args(false);
  return [settings] { return run_serve(*settings); };
}

}  // namespace

extern const Verb serve_verb{"serve",
                             "  rehearse serve walk.mcap\n"
                             "  rehearse serve Hold.ComesBackAfterAPush --loop\n"
                             "  rehearse serve walk.mcap --port 0 --speed 0.1\n"
                             "  rehearse serve walk.mcap --follow\n",
                             declare_serve};

}  // namespace rehearse::tool
