// Runs scenarios of the fixtures in a process of its own:
//   determinism_probe record FOLDER SECONDS [--not-pinned] [--beside] [--nudge] [--costs] SCENARIO...
//     records each, one after the other, its first SECONDS (or "all"), as FOLDER/<name>.mcap; a name that is there
//     twice is recorded twice, and the later one counts. FOLDER/made_by.txt then tells the processor, the compiler,
//     whether the process is pinned, and what fresh memory is full of.
//     --not-pinned: as the environment has it. --beside: tick by tick in turns with the scenario behind it, which is
//     not kept. --nudge: from a place that is off by a last bit. --costs: with the costs of control().
//   determinism_probe go-on SCENARIO SOLVER TRACE RECORDING TICK
//     goes on from a checkpoint of a recording, under its commands
#include <fmt/format.h>
#include <rehearse/pin.h>
#include <rehearse/session.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#if defined(__x86_64__)
#include <cpuid.h>
#endif

namespace {

using namespace rehearse;
namespace fs = std::filesystem;

struct Order {
  fs::path folder;
  std::optional<double> first;  // [s]; none: all
  bool beside = false;          // each in turns with the next
  RecordOptions options;
  std::vector<fs::path> scenarios;
};

int fail(const Diagnostics& errors) { return std::fputs(to_string(errors).c_str(), stderr), 1; }

/// The processor's name from the processor itself; /proc/cpuinfo would not contain the emulated one.
std::string processor() {
#if defined(__x86_64__)
  char name[49] = "";
  for (std::size_t part = 0; part < 3; ++part) {
    std::uint32_t words[4] = {};
    if (!__get_cpuid(0x80000002u + static_cast<unsigned>(part), &words[0], &words[1], &words[2], &words[3]))
      return "unnamed processor";
    std::memcpy(name + 16 * part, words, sizeof words);
  }
  const std::string_view text = name;
  return std::string(text.substr(0, text.find_last_not_of(' ') + 1));
#elif defined(__aarch64__)
  return "arm64";
#else
  return "unnamed processor";
#endif
}

/// A byte of what malloc gives where something else was written before, in hexadecimal.
std::string fresh_memory() {
  constexpr std::size_t size = 40, place = 30;  // behind the allocator's list pointers, which are at the beginning
  // prevents the compiler from removing the read of uninitialised memory
  void* (*volatile allocate)(std::size_t) = std::malloc;
  auto* used = static_cast<volatile unsigned char*>(allocate(size));
  used[place] = 0x77;
  std::free(const_cast<unsigned char*>(used));
  auto* fresh = static_cast<volatile unsigned char*>(allocate(size));
  const unsigned found = fresh[place];
  std::free(const_cast<unsigned char*>(fresh));
  return fmt::format("{:#04x}", found);
}

std::string made_by() {
#if defined(__clang__)
  const std::string compiler = fmt::format("clang {}.{}", __clang_major__, __clang_minor__);
#else
  const std::string compiler = fmt::format("gcc {}.{}", __GNUC__, __GNUC_MINOR__);
#endif
#if defined(__OPTIMIZE__)
  const char* how = "optimised";
#else
  const char* how = "not optimised";
#endif
  return fmt::format("{}\n{}, {}\n{}\n{}", processor(), compiler, how, is_pinned() ? "pinned" : "not pinned",
                     fresh_memory());
}

template <class Number>
std::optional<Number> number_in(std::string_view text) {
  Number number{};
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (problem != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

Result<Scenario> load(const fs::path& file, const Order& order) {
  auto scenario = Scenario::load(file);
  if (scenario && order.first) scenario->duration = std::min(scenario->duration, *order.first);
  return scenario;
}

/// Two sessions in turns. The other one is begun again whenever it is over.
Result<RunSummary> record_beside(const Scenario& scenario, const Scenario& other, const fs::path& trace,
                                 const RecordOptions& options) {
  const fs::path other_trace = trace.string() + ".other";
  auto session = Session::create(scenario, trace, options);
  if (!session) return session.errors();
  auto beside = Session::create(other, other_trace, options);
  for (;;) {
    if (!beside) return beside.errors();
    const Result<bool> going_on = (*session)->step();
    if (!going_on) return going_on.errors();
    if (!*going_on) break;
    const Result<bool> other_going_on = (*beside)->step();
    if (!other_going_on) return other_going_on.errors();
    if (*other_going_on) continue;
    if (const auto done = (*beside)->finish(); !done) return done.errors();
    beside = Session::create(other, other_trace, options);
  }
  auto summary = (*session)->finish();
  std::error_code ignored;
  fs::remove(other_trace, ignored);
  return summary;
}

int record_all(const Order& order) {
  for (std::size_t i = 0; i < order.scenarios.size(); ++i) {
    const auto scenario = load(order.scenarios[i], order);
    if (!scenario) return fail(scenario.errors());
    const fs::path trace = order.folder / (order.scenarios[i].stem().string() + ".mcap");
    Result<RunSummary> summary = RunSummary{};
    if (order.beside) {
      const auto other = load(order.scenarios[(i + 1) % order.scenarios.size()], order);
      if (!other) return fail(other.errors());
      summary = record_beside(*scenario, *other, trace, order.options);
    } else {
      summary = record(*scenario, trace, order.options);
    }
    if (!summary) return fail(summary.errors());
    if (summary->failure) return fail({*summary->failure});
  }
  std::ofstream(order.folder / "made_by.txt") << made_by() << '\n';
  return 0;
}

int go_on(const std::vector<std::string_view>& words) {
  const auto tick = number_in<std::int64_t>(words[5]);
  if (!tick) return fail({error(fmt::format("'{}' is no tick", words[5]))});
  auto scenario = Scenario::load(words[1]);
  if (!scenario) return fail(scenario.errors());
  const auto& names = SolverSettings::method_names;
  const auto method = std::ranges::find(names, words[2]);
  if (method == names.end()) return fail({error(fmt::format("'{}' is no solver", words[2]))});
  scenario->solver.method = static_cast<SolverSettings::Method>(method - names.begin());
  const auto recording = Trace::load(words[4]);
  if (!recording) return fail(recording.errors());
  PlantOptions options;
  options.from = *tick;
  options.resync = false;
  const auto summary = run_plant(*scenario, *recording, words[3], options);
  if (!summary) return fail(summary.errors());
  return summary->failure || summary->restored != 1 ? 1 : 0;
}

int run(const std::vector<std::string_view>& words) {
  if (words.size() == 6 && words[0] == "go-on") return go_on(words);
  if (words.size() < 4 || words[0] != "record") return fail({error("bad usage", "see the top of the source")});
  Order order;
  order.folder = words[1];
  order.first = number_in<double>(words[2]);
  if (!order.first && words[2] != "all") return fail({error(fmt::format("'{}' are no seconds", words[2]))});
  for (std::size_t i = 3; i < words.size(); ++i) {
    if (words[i] == "--beside")
      order.beside = true;
    else if (words[i] == "--nudge")
      order.options.nudge = 1;
    else if (words[i] == "--costs")
      order.options.counts_costs = true;
    else if (words[i] != "--not-pinned")
      order.scenarios.emplace_back(words[i]);
  }
  return record_all(order);
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string_view> words(argv + 1, argv + argc);
  if (std::ranges::find(words, "--not-pinned") == words.end()) pin_process(argv);
  return run(words);
}
