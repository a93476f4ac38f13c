#include "branch_recording.h"

#include <fmt/format.h>
#include <rehearse/scenario.h>

#include <cstdio>
#include <filesystem>

#include "host/interposer.h"
#include "host/virtualised.h"
#include "mcap/replaceable.h"
#include "options.h"
#include "output.h"
#include "progress.h"
#include "scenario_text.h"

namespace rehearse::tool {
namespace {

void tell(const BranchSettings& settings, const BranchSummary& branch, double seconds) {
  fmt::print("branched off {} at tick {} ({:g} s): {}\n", settings.from.substr(0, settings.from.rfind('@')),
             branch.tick, branch.time, branch.world);
  const ReplayReport& before = branch.before;
  if (before.ticks > 0)
    fmt::print("before it the controllers, on the recorded inputs, {}\n",
               before.equal() ? "repeat their commands bit for bit" : "differ first at " + to_string(*before.first));
  fmt::print("{} simulated from there, in {:.2f} s\n", count_text(branch.run.ticks - branch.tick, "tick"), seconds);
  fmt::print("{}, {}, {}{} in {}\n", count_text(branch.run.ticks, "tick"), count_text(branch.run.channels, "channel"),
             count_text(branch.run.frames, "camera frame"),
             branch.run.bytes > 0 ? ", " + file_size_text(branch.run.bytes) : "", settings.trace);
}

}  // namespace

void add_branch_options(CLI::App& options, BranchSettings& settings) {
  options
      .add_option(
          "--from-checkpoint", settings.from,
          "begin as this recording and go on from the moment, as TRACE@3.2s or TRACE@tick:640; scenario and models "
          "are the recording's (SCENARIO only if these have meshes), --duration counts from the moment")
      ->type_name("TRACE@MOMENT");
  add_number(options, "--until", "of a branch: the end as time of the run [s]", 0.0, Scenario::max_duration,
             [&settings](double until) { settings.options.until = until; });
  options
      .add_option("--set", settings.options.set,
                  "of a branch: alter inputs of controllers, as 'Walker/KNEE/q+=0.05@3.2s..3.4s'; repeatable")
      ->type_name("SERIES=VALUE")
      ->allow_extra_args(false);
  options
      .add_option("--push", settings.options.push,
                  "of a branch: push a link, as 'Walker/TRUNK force=0,0,50 @3.2s..3.3s'; torque=, at=; repeatable")
      ->type_name("PUSH")
      ->allow_extra_args(false);
}

bool is_about_a_branch(const BranchSettings& settings) {
  return settings.options.until || !settings.options.set.empty() || !settings.options.push.empty();
}

Exit record_branch_of(BranchSettings settings) {
  const auto from = BranchPoint::parse(settings.from);
  if (!from) return refuse(error("--from-checkpoint: " + from.errors()[0].message));
  if (settings.trace.empty()) settings.trace = from->trace.stem().string() + ".branch.mcap";
  if (const auto allowed = check_replaceable(settings.trace, mcap_magic, "trace"); !allowed)
    return refuse(allowed.errors());
  if (const auto ready = virtualise_process_like(from->trace.string()); !ready) return refuse(ready.errors());
  InterposerWatch watch;
  if (is_interposed()) settings.options.watch = &watch;
  const Stopwatch stopwatch;
  const auto branch = [&] {
    Progress progress("branching");
    settings.options.progress = [&](std::int64_t done, std::int64_t all) { progress.show(done, all); };
    return record_branch(*from, settings.trace, settings.options);
  }();
  if (!branch) return refuse(branch.errors());
  tell(settings, *branch, stopwatch.seconds());
  std::fflush(stdout);  // before related output on stderr
  tell_remarks(branch->run);
  return branch->run.failure || branch->run.controller_refused ? Exit::controller_failed : Exit::done;
}

}  // namespace rehearse::tool
