// rehearse tap: makes a recording of what a robot's loop writes into its tap.
#include <fmt/format.h>
#include <signal.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "base/text.h"
#include "command.h"
#include "logs/flight/flight.h"
#include "logs/flight/tap_ring.h"
#include "options.h"
#include "output.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

std::atomic<bool> is_asked_to_stop{false}, is_asked_to_keep{false};

extern "C" void take_stop(int) { is_asked_to_stop = true; }
extern "C" void take_keep(int) { is_asked_to_keep = true; }

void handle_signals() {
  struct sigaction action {};
  action.sa_handler = take_stop;
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaction(number, &action, nullptr);
  action.sa_handler = take_keep;
  sigaction(SIGUSR1, &action, nullptr);
}

struct TapSettings {
  std::string name;
  bool recovers = false, again = false;
  FlightOptions options;
};

/// The ring's file: a name, or the path of a file.
fs::path file_of(const TapSettings& settings) {
  return settings.name.find('/') == std::string::npos ? TapRing::file_of(settings.name) : fs::path(settings.name);
}

/// Waits for the loop that opens the tap; null: the user stops.
Result<std::unique_ptr<TapRing>> wait_for_ring(const fs::path& file, const std::string& name) {
  bool is_told = false;
  for (; !is_asked_to_stop; std::this_thread::sleep_for(std::chrono::milliseconds(20))) {
    auto ring = TapRing::open(file, TapRing::Use::takes);
    if (!ring || *ring) return ring;
    if (!is_told) fmt::print(stderr, "waiting for a loop that opens the tap '{}'\n", name);
    is_told = true;
  }
  return std::unique_ptr<TapRing>();
}

void tell(const TapSettings& settings, const FlightReport& report) {
  for (const Diagnostic& remark : report.remarks) fmt::print(stderr, "{}", to_string({remark}));
  std::string ended;
  switch (report.end) {
    case FlightEnd::closed: ended = "the loop closed its tap"; break;
    case FlightEnd::loop_ended: ended = "the loop's process ended without closing its tap"; break;
    case FlightEnd::stopped: ended = "the recording was stopped"; break;
    case FlightEnd::disk_full: ended = "the disk is nearly full (--keep-free)"; break;
  }
  fmt::print("{}; {} recorded", ended, count_text(report.ticks, "tick"));
  for (std::size_t i = 0; i < report.files.size(); ++i)
    fmt::print("{}{}", i == 0 ? " in " : ", ", report.files[i].string());
  fmt::print("\n");
  if (report.missing > 0)
    fmt::print("{} are missing between them: the ring was full before they were recorded; a larger `megabytes` helps\n",
               count_text(report.missing, "tick"));
  if (report.dropped > 0) fmt::print("the loop counted {} as dropped\n", count_text(report.dropped, "tick"));
  if (report.refused > 0)
    fmt::print("{} of the loop broke a rule of <rehearse/tap.h>, and wrote nothing\n",
               count_text(report.refused, "call"));
  if (report.damaged > 0)
    fmt::print("the ring was damaged in {}: something else wrote into it\n", count_text(report.damaged, "place"));
  if (report.files.empty() && settings.options.is_black_box) fmt::print("nothing asked for the black box\n");
  std::fflush(stdout);
}

Exit exit_of(const FlightReport& report, bool recovers) {
  if (report.end == FlightEnd::disk_full) return Exit::bad_input;
  if (report.end == FlightEnd::loop_ended && !recovers) return Exit::controller_failed;
  return report.missing > 0 || report.damaged > 0 ? Exit::odd : Exit::done;
}

Exit end(const TapSettings& settings, const TapRing& ring, const Result<FlightReport>& report) {
  if (!report) return refuse(report.errors());
  tell(settings, *report);
  // All of it is in a recording, or nobody asked for a black box.
  if (!ring.has_loop() && report->end != FlightEnd::disk_full) ring.remove_file();
  return exit_of(*report, settings.recovers);
}

Exit run_tap(TapSettings& settings) {
  const fs::path file = file_of(settings);
  if (settings.options.output.empty()) settings.options.output = fs::path(settings.name).filename().string() + ".mcap";
  handle_signals();
  settings.options.tell = [](const std::string& sentence) { fmt::print(stderr, "{}\n", sentence); };
  settings.options.stops = [] { return is_asked_to_stop.load(); };
  settings.options.keeps_now = [] { return is_asked_to_keep.exchange(false); };
  if (settings.recovers) {
    const auto ring = TapRing::open(file, TapRing::Use::looks);
    if (!ring) return refuse(ring.errors());
    if (!*ring) return refuse(error(fmt::format("there is no ring of a tap '{}'", settings.name)));
    return end(settings, **ring, save_ring(**ring, settings.name, settings.options));
  }
  for (Exit worst = Exit::done;;) {
    const auto ring = wait_for_ring(file, settings.name);
    if (!ring) return refuse(ring.errors());
    if (!*ring) return worst;
    const Exit ended = end(settings, **ring, record_flight(**ring, settings.name, settings.options));
    if (ended != Exit::done && worst != Exit::bad_input) worst = ended;
    if (!settings.again || is_asked_to_stop || ended == Exit::bad_input) return worst;
  }
}

std::function<Exit()> declare_tap(CLI::App& options) {
  const auto settings = std::make_shared<TapSettings>();
  FlightOptions& flight = settings->options;
  constexpr double megabyte = 1e6, most_megabytes = 1e9;
  options.add_option("NAME", settings->name, "the name of the tap that a loop opens; a path: the file of a ring")
      ->required()
      ->type_name("");
  options
      .add_option_function<std::string>(
          "-o,--output", [settings](const std::string& file) { settings->options.output = file; },
          "the recording (NAME.mcap); if it exists, FILE-2, and so on")
      ->type_name("FILE");
  options.add_flag("--black-box", flight.is_black_box,
                   "write only the last seconds, when the loop marks them, its process dies, an effort is beyond the "
                   "model's, or SIGUSR1 comes");
  add_number(options, "--last",
             "the length of a black box [s], and of what --recover writes (as the tap states it; all)", 1e-3, 1e6,
             [settings](double seconds) { settings->options.seconds = seconds; });
  add_number(
      options, "--split",
      "write FILE_0, FILE_1, ...: another file begins when one is larger [MB]; a folder of them is one recording", 1,
      most_megabytes,
      [settings](double size) { settings->options.part_size = static_cast<std::uint64_t>(size * megabyte); });
  flight.keep_free = 256'000'000;
  add_number(options, "--keep-free", "end the recording when its disk has less room [MB] (256)", 0, most_megabytes,
             [settings](double size) { settings->options.keep_free = static_cast<std::uint64_t>(size * megabyte); });
  options.add_flag("--recover", settings->recovers,
                   "write what is in the ring now, also of a loop that has ended, and end");
  options.add_flag("--again", settings->again, "then wait for the next loop that opens the tap, until a signal comes")
      ->excludes("--recover");
  return [settings] { return run_tap(*settings); };
}

}  // namespace

extern const Verb tap_verb{
    "tap",
    "  rehearse tap walker -o friday.mcap\n"
    "  rehearse tap walker --black-box --last 30\n"
    "  rehearse tap walker --recover -o crash.mcap\n"
    "\n"
    "It waits for a loop that opens the tap (<rehearse/tap.h>), and ends with it, or on SIGINT and SIGTERM.\n"
    "\n"
    "Exit status: 0 the loop closed its tap, or a signal ended the recording; 2 bad input, or the disk is full;\n"
    "3 the loop's process ended without closing its tap; 4 ticks are missing. The recording is whole in each case.\n",
    declare_tap};

}  // namespace rehearse::tool
