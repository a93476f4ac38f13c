#include "interposer.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <cstring>

#include "core/guard/cost_counter.h"
#include "core/guard/own_library.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr const char* library_name = "librehearse_interposer.so";
constexpr const char* settings_variable = "REHEARSE_INTERPOSER";

using Enter = void (*)(const char* controller, const char* library, const char* function, long long tick, double time);
using Call = void (*)();
using NoteCost = void (*)(const char* cost, const char* function);

/// The functions of the interposer for its host; null if this process runs without it.
struct Interposer {
  Call begin = reinterpret_cast<Call>(dlsym(RTLD_DEFAULT, "rehearse_interposer_begin"));
  Enter enter = reinterpret_cast<Enter>(dlsym(RTLD_DEFAULT, "rehearse_interposer_enter"));
  Call leave = reinterpret_cast<Call>(dlsym(RTLD_DEFAULT, "rehearse_interposer_leave"));
  NoteCost note_cost = reinterpret_cast<NoteCost>(dlsym(RTLD_DEFAULT, "rehearse_interposer_note_cost"));
};

const Interposer& interposer() {
  static const Interposer found;
  return found;
}

/// Settings are separated by semicolons, which a path may contain, too.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char letter : text) {
    if (letter == ';' || letter == '%')
      result += fmt::format("%{:02x}", static_cast<unsigned char>(letter));
    else
      result += letter;
  }
  return result;
}

/// "clock.date=...;seed=...;": whole numbers, which have the same text in any locale.
std::string text_of(const Substitution& substitution, std::string_view prefix) {
  std::string text;
  const auto add = [&](std::string_view name, auto value) { text += fmt::format("{}{}={};", prefix, name, value); };
  if (const auto& clock = substitution.clock) {
    add("clock.date", clock->date);
    add("clock.uptime", clock->uptime);
    add("clock.rate", clock->rate);
    add("clock.read_step", clock->read_step);
  }
  if (substitution.seed) add("seed", *substitution.seed);
  if (substitution.machine > 0) add("machine", substitution.machine);
  if (substitution.threads == ThreadSchedule::late) add("threads", "late");
  if (substitution.threads == ThreadSchedule::early) add("threads", "early");
  if (substitution.slow > 0) add("slow", substitution.slow);
  return text;
}

std::string text_of(const InterposerSettings& settings) {
  std::string text;
  if (!settings.log.empty()) text += "log=" + escaped(fs::absolute(settings.log).string()) + ";";
  if (!settings.files.empty()) text += "files=" + escaped(fs::absolute(settings.files).string()) + ";";
  text += text_of(settings.everywhere, "");
  if (settings.only) {
    text += fmt::format("only={}+{:x};", escaped(settings.only->module), settings.only->offset);
    text += text_of(settings.there, "there.");
  }
  return text;
}

/// Puts a value in front of the variable's own.
std::string with_own(const char* variable, std::string value, char separator) {
  const char* own = std::getenv(variable);
  return own && *own ? value + separator + own : value;
}

}  // namespace

SimulatedClock SimulatedClock::shifted() const {
  SimulatedClock other = *this;
  other.date += 400 * 86'400'000'000'000 + 12'345'678'901'234;  // a different year, weekday, hour and fraction
  other.uptime += 7'654'321'098'765;
  other.rate *= 3;
  other.read_step *= 3;
  return other;
}

Result<fs::path> interposer_library() {
  const fs::path file = own_library_folder() / library_name;
  std::error_code ignored;
  if (fs::is_regular_file(file, ignored)) return file;
  return error("the interposer is missing: " + file.string(), "it is installed beside Rehearse's other libraries");
}

Result<std::map<std::string, std::optional<std::string>>> interposer_environment(const InterposerSettings& settings) {
  const auto library = REHEARSE_TRY(interposer_library());
  if (library.string().find_first_of(": ") != std::string::npos)
    return error("the interposer can't be loaded from " + library.string(),
                 "LD_PRELOAD takes no path with a space or a colon");
  std::map<std::string, std::optional<std::string>> changes;
  changes["LD_PRELOAD"] = with_own("LD_PRELOAD", library.string(), ':');
  changes[settings_variable] = text_of(settings);
  // Without this AddressSanitizer demands to be loaded first.
  changes["ASAN_OPTIONS"] = with_own("ASAN_OPTIONS", "verify_asan_link_order=0", ':');
  return changes;
}

void log_costs() {
  if (interposer().note_cost)
    observe_costs([](Cost cost, const char* function) { interposer().note_cost(to_string(cost).data(), function); });
}

bool is_interposed() { return interposer().enter != nullptr; }

__attribute__((noinline, no_sanitize("address"))) void StackFill::paint() const {
  void* const below = __builtin_alloca(depth);
  std::memset(below, pattern_, depth);
  asm volatile("" : : "r"(below) : "memory");  // prevents the compiler from removing the writes, which no code reads
}

InterposerWatch::InterposerWatch(std::optional<StackFill> fill) : fill_(fill) {
  if (interposer().begin) interposer().begin();
}

void InterposerWatch::enter(const ControllerCall& call) {
  if (interposer().enter)
    interposer().enter(call.controller.c_str(), call.library.c_str(), call.function, call.tick, call.time);
  if (fill_) fill_->paint();  // last, because every call writes to the stack, too
}

void InterposerWatch::leave() {
  if (interposer().leave) interposer().leave();
}

}  // namespace rehearse
