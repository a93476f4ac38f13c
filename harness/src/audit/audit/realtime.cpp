#include "realtime.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "symbols.h"

namespace rehearse {
namespace {

std::vector<std::string> callers_of(const ObservedCall& call) {
  const Symbols symbols(call.place.module);
  std::vector<std::string> callers;
  for (const std::uint64_t address : call.outer) {
    const Symbols::Found found = symbols.find(address);
    if (!found.is_systems && !found.line.empty()) callers.push_back(symbols.describe(address));
  }
  return callers;
}

/// "allocation by malloc in Filter::update() (filter.cpp:31) at tick 512"
std::string text_of(const AuditedCost& cost) {
  return fmt::format("{} by {} in {}, {}", cost.cost, cost.function, cost.place,
                     cost.count == 1 ? fmt::format("once, at tick {}", cost.first_tick)
                                     : fmt::format("{} times from tick {} on", cost.count, cost.first_tick));
}

}  // namespace

std::vector<AuditedCost> costs_in(const CallLog& log, const std::string& controller) {
  std::vector<AuditedCost> costs;
  for (const ObservedCall& call : log.calls) {
    if (call.source != ObservedCall::Source::cost || call.controller != controller) continue;
    AuditedCost cost{call.argument, call.function, call.phase, place_of(call), callers_of(call)};
    cost.first_tick = call.first_tick;
    cost.last_tick = call.last_tick;
    cost.count = call.count;
    std::erase(cost.callers, cost.place);  // it isn't its own caller
    // The compiler may have made several calls of one line.
    const auto known = std::ranges::find_if(costs, [&](const AuditedCost& other) {
      return other.cost == cost.cost && other.function == cost.function && other.phase == cost.phase &&
             other.place == cost.place && other.callers == cost.callers;
    });
    if (known == costs.end()) {
      costs.push_back(std::move(cost));
    } else {
      known->last_tick = std::max(known->last_tick, cost.last_tick);
      known->count += cost.count;
    }
  }
  return costs;
}

bool breaks_realtime(const ControllerAudit& controller) {
  return std::ranges::any_of(controller.costs, [](const AuditedCost& cost) { return cost.breaks_realtime(); });
}

std::string realtime_verdict(const AuditReport& report, bool complete) {
  std::vector<std::string> safe, not_safe;
  for (const ControllerAudit& controller : report.controllers) {
    const auto first = std::ranges::find_if(controller.costs, [](const auto& cost) { return cost.breaks_realtime(); });
    if (first == controller.costs.end()) {
      safe.push_back(controller.controller);
      continue;
    }
    const auto places =
        std::ranges::count_if(controller.costs, [](const auto& cost) { return cost.breaks_realtime(); });
    not_safe.push_back(fmt::format("{} isn't real-time safe: {}{}", controller.controller, text_of(*first),
                                   places == 1   ? ""
                                   : places == 2 ? "; and at one more place"
                                                 : fmt::format("; and at {} more places", places - 1)));
  }
  if (!not_safe.empty()) return fmt::format("{}", fmt::join(not_safe, "; "));
  return fmt::format(
      "{} {} real-time safe in {} ticks, as to calls: no allocation, lock, system call or exception "
      "after tick 0{}; not measured: duration",
      fmt::join(safe, ", "), safe.size() == 1 ? "is" : "are", report.ticks,
      complete ? "" : ", as far as the log of the calls reaches");
}

}  // namespace rehearse
