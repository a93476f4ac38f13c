#include "control_times.h"

#include <fmt/format.h>

#include <cstdio>

#include "core/host/control_times_json.h"
#include "options.h"

namespace rehearse::tool {
namespace {

/// In microseconds: the unit stays the same on slow and fast machines.
std::string time_text(double seconds) { return fmt::format("{:.3g} µs", seconds * 1e6); }

Json json_of(const ControlCosts::Count& count) {
  return {{"total", count.total},
          {"ticks", count.ticks},
          {"first_tick", count.total > 0 ? Json(count.first_tick) : Json(nullptr)}};
}

Json json_of(const ControlCosts& costs) {
  Json object{{"realtime_safe", costs.is_realtime_safe()}, {"page_faults", json_of(costs.page_faults)}};
  for (const ControlCosts::Count& count : costs.counts) object[std::string(count.name)] = json_of(count);
  return object;
}

}  // namespace

void add_deadline_option(CLI::App& options, std::optional<double>& deadline) {
  add_number(options, "--deadline", "warn of a control() that took longer, by this machine's clock [ms of wall time]",
             1e-6, 1e6, [&deadline](double milliseconds) { deadline = milliseconds * 1e-3; });
}

void add_timing_options(CLI::App& options, std::optional<double>& deadline, HostOptions& host) {
  add_deadline_option(options, deadline);
  options.add_flag("--realtime", host.counts_costs,
                   "count and record allocations, locks, system calls and exceptions of control()");
}

void tell_page_faults(const ControlCosts::Count& faults) {
  if (faults.total > 0)
    fmt::print("  on this machine, {} in {}, first at tick {}\n",
               count_text(static_cast<std::int64_t>(faults.total), "page fault"), count_text(faults.ticks, "tick"),
               faults.first_tick);
}

void tell_control_times(const std::vector<ControlTimes>& all) {
  for (const ControlTimes& times : all) {
    fmt::print("control() of {}: median {}, 99.9 % within {}, longest {} at tick {}: {:.3g} % of the period\n",
               plain_text(times.controller), time_text(times.median), time_text(times.p999), time_text(times.longest),
               times.longest_tick, 100.0 * times.longest / times.period);
    if (!times.costs) continue;
    fmt::print("{}\n", plain_text(realtime_sentence(times)));
    tell_page_faults(times.costs->page_faults);
  }
}

void tell_missed_deadlines(const std::vector<ControlTimes>& all, std::optional<double> deadline) {
  if (!deadline) return;
  for (const ControlTimes& times : all)
    if (times.longest > *deadline)
      fmt::print(stderr, "{}\n",
                 to_string(warning(fmt::format("control() of {} took {} at tick {}, longer than the deadline of {}",
                                               plain_text(times.controller), time_text(times.longest),
                                               times.longest_tick, time_text(*deadline)),
                                   "by this machine's clock, with all that ran beside it")));
}

const std::vector<ControlTimes>& control_times_of(const CheckReport& report) {
  static const std::vector<ControlTimes> none;
  if (report.run) return report.run->control_times;
  return report.replay ? report.replay->control_times : none;
}

Json json_of(const std::vector<ControlTimes>& all) {
  Json list = Json::array();
  for (const ControlTimes& times : all) {
    Json& object = list.emplace_back(rehearse::json_of(times));
    object["costs"] = times.costs ? json_of(*times.costs) : Json(nullptr);
  }
  return list;
}

}  // namespace rehearse::tool
