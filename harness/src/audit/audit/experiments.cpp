#include "experiments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "aspects.h"
#include "core/guard/own_library.h"
#include "core/host/virtualised.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using Source = ObservedCall::Source;

// malloc() fills the memory that it returns with the complement: with 0xc0 a double is -8577.5 and a bool true, with
// 0x00 all is zero.
constexpr unsigned char first_fill = 0x3f;
constexpr unsigned char other_fills[] = {0xff, 0xbe, 0x55};

/// Makes holes as in a used heap, in all still replays. Then freed memory is reused later and keeps its fill, instead
/// of being returned by the next allocation.
constexpr std::uint32_t usual_padding = 1;

/// For all still replays. Even numbers are small machines, odd numbers large ones.
constexpr int usual_machine = 1;

constexpr const char* comma_locale = "de_DE.UTF-8";

bool any_of_source(const std::vector<ObservedCall>& calls, Source source) {
  return std::ranges::any_of(calls, [=](const ObservedCall& call) { return call.source == source; });
}

std::string locale_in_force() {
  for (const char* variable : {"LC_ALL", "LC_NUMERIC", "LANG"})
    if (const char* value = std::getenv(variable); value && *value) return value;
  return "C";
}

/// The folder of locales that was built with this library; empty if it doesn't exist.
fs::path locale_folder() {
  const fs::path folder = own_library_folder() / "rehearse" / "locale";
  std::error_code ignored;
  for (const char* name : {"de_DE.utf8", comma_locale})
    if (fs::is_directory(folder / name, ignored)) return folder;
  return {};
}

class Plan {
 public:
  Plan(const AuditOptions& options, const std::vector<ObservedCall>& calls, bool unseen)
      : options_(options), calls_(calls), unseen_(unseen) {}

  std::vector<Experiment> make() {
    vary_process();
    vary_locale();
    vary_machine();
    vary_virtualised();
    vary_threads();
    for (int i = 0; i < options_.repeat; ++i)
      still(Factor::again, i).passes = 2;  // the first pass repeats the still replay
    return std::move(experiments_);
  }

 private:
  bool any_goes_by(Factor factor) const {
    return std::ranges::any_of(calls_, [=](const ObservedCall& call) { return aspect_of(call).factor == factor; });
  }
  bool calls(Source source) const { return unseen_ || any_of_source(calls_, source); }

  Experiment& experiment(Factor factor) {
    for (Experiment& known : experiments_)
      if (known.factor == factor) return known;
    Experiment& added = experiments_.emplace_back();
    added.factor = factor;
    return added;
  }
  ReplaySettings& add(Factor factor, int number, ReplaySettings settings, const char* kind = "") {
    settings.name = fmt::format("{}{}_{}", to_string(factor), kind, number + 1);
    return experiment(factor).settings.emplace_back(std::move(settings));
  }
  ReplaySettings& still(Factor factor, int number, const char* kind = "") {
    return add(factor, number, still_replay(options_), kind);
  }

  void vary_process() {
    const bool by_folder = any_goes_by(Factor::folder);
    for (int i = 0; i < options_.repeat; ++i) {
      add(Factor::nothing, i, plain_replay(options_));
      still(Factor::memory, i).fill = other_fills[static_cast<std::size_t>(i) % std::size(other_fills)];
      ReplaySettings& addresses = still(Factor::addresses, i);
      addresses.other_addresses = true;
      addresses.padding = usual_padding + static_cast<std::uint32_t>(i) + 1;
      still(Factor::environment, i).other_environment = true;
      if (by_folder) still(Factor::folder, i).other_folder = true;
    }
    if (!by_folder) experiment(Factor::folder).not_varied = "no file was named relative to it";
  }

  void vary_locale() {
    const fs::path folder = locale_folder();
    if (!calls(Source::locale)) {
      experiment(Factor::locale).not_varied = "nothing asked for it";
    } else if (folder.empty()) {
      experiment(Factor::locale).not_varied = fmt::format("there is no {} on this machine", comma_locale);
    } else {
      const bool is_german = locale_in_force().starts_with("de");
      for (int i = 0; i < options_.repeat; ++i)
        still(Factor::locale, i).environment = {{"LC_ALL", is_german ? "C" : comma_locale},
                                                {"LANG", is_german ? "C" : comma_locale},
                                                {"LOCPATH", folder.string()}};
    }
  }

  void vary_machine() {
    if (!unseen_ && !any_goes_by(Factor::machine)) {
      experiment(Factor::machine).not_varied = "nothing asked for it";
      return;
    }
    for (int i = 0; i < options_.repeat; ++i) {
      still(Factor::machine, i, "_real").everywhere.machine = 0;
      still(Factor::machine, i, "_small").everywhere.machine = usual_machine + 1 + 2 * i;
      still(Factor::machine, i, "_large").everywhere.machine = usual_machine + 2 + 2 * i;
    }
  }

  void vary_virtualised() {
    for (const auto& [factor, source] : {std::pair{Factor::clock, Source::clock}, {Factor::random, Source::random}}) {
      if (options_.virtualise)
        experiment(factor).not_varied = "it is given by --virtualise";
      else if (!calls(source))
        experiment(factor).not_varied = "nothing asked for it";
    }
    if (options_.virtualise) return;
    if (calls(Source::clock)) still(Factor::clock, 0, "_real").everywhere.clock.reset();
    if (calls(Source::random)) still(Factor::random, 0, "_real").everywhere.seed.reset();
    SimulatedClock clock;
    for (int i = 0; i < options_.repeat; ++i) {
      clock = clock.shifted();
      if (calls(Source::clock)) still(Factor::clock, i).everywhere.clock = clock;
      if (calls(Source::random))
        still(Factor::random, i).everywhere.seed = options_.seed + 1 + static_cast<unsigned>(i);
    }
  }

  void vary_threads() {
    if (!calls(Source::thread)) experiment(Factor::threads).not_varied = "no thread was started";
    if (!calls(Source::thread)) return;
    for (int i = 0; i < options_.repeat; ++i) {
      still(Factor::threads, i, "_late").everywhere.threads = ThreadSchedule::late;
      still(Factor::threads, i, "_early").everywhere.threads = ThreadSchedule::early;
      still(Factor::threads, i, "_slow").everywhere.slow = 200;
    }
  }

  const AuditOptions& options_;
  const std::vector<ObservedCall>& calls_;
  bool unseen_;
  std::vector<Experiment> experiments_;
};

}  // namespace

ReplaySettings plain_replay(const AuditOptions& options) {
  ReplaySettings settings;
  settings.name = "plain";
  if (options.virtualise) settings.everywhere = virtualised(options.seed);
  return settings;
}

ReplaySettings still_replay(const AuditOptions& options) {
  ReplaySettings settings;
  settings.name = "still";
  settings.everywhere = virtualised(options.seed);
  settings.everywhere.machine = usual_machine;
  settings.fill = first_fill;
  settings.padding = usual_padding;
  settings.other_addresses = false;
  return settings;
}

std::vector<Experiment> plan_experiments(const AuditOptions& options, const std::vector<ObservedCall>& calls,
                                         bool unseen) {
  return Plan(options, calls, unseen).make();
}

ReplaySettings other_answer_at(const AuditOptions& options, const ObservedCall& call, int number) {
  ReplaySettings settings = still_replay(options);
  settings.name = fmt::format("only_{}", number);
  settings.only = call.place;
  settings.there = settings.everywhere;
  if (call.source == Source::clock) settings.there.clock = SimulatedClock{}.shifted();
  if (call.source == Source::random) settings.there.seed = options.seed + 1;
  if (aspect_of(call).factor == Factor::machine) settings.there.machine = usual_machine + 1;
  return settings;
}

}  // namespace rehearse
