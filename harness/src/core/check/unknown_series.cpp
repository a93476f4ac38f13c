#include "unknown_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/glob.h"
#include "core/compare/series_rules.h"
#include "core/kinds/channel_name.h"
#include "formula_judge.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// "a/b/c" as a, b, and "c".
std::vector<std::string> segments_of(std::string_view name) {
  std::vector<std::string> segments;
  for (std::size_t at = 0; at <= name.size();) {
    const std::size_t end = std::min(name.find('/', at), name.size());
    segments.emplace_back(name.substr(at, end - at));
    at = end + 1;
  }
  return segments;
}

bool is_pattern(std::string_view name) { return name.find('*') != std::string_view::npos; }

bool has_controller(const ScenarioBody& body, std::string_view name) {
  const auto is_named = [name](const ScenarioController& controller) { return topic_segment(controller.name) == name; };
  return std::ranges::any_of(body.controllers, [&](const ScenarioController& controller) {
    return is_named(controller) || std::ranges::any_of(controller.children, is_named);
  });
}

/// The device of a body by the segment that names it in series; null: there is none.
const Device* find_device(const Model& model, std::string_view segment) {
  const auto is_named = [segment](const Device& device) { return topic_segment(device.name) == segment; };
  const auto found = std::ranges::find_if(model.devices, is_named);
  return found == model.devices.end() ? nullptr : &*found;
}

bool has_link_or_joint(const Model& model, std::string_view segment) {
  return std::ranges::any_of(model.links, [segment](const Link& link) {
    return topic_segment(link.name) == segment || topic_segment(link.joint.name) == segment;
  });
}

/// Answers whether a run of a scenario may record a series that is in none of the traces.
class Possible {
 public:
  Possible(const Scenario& scenario, std::span<const Trace* const> traces) : scenario_(scenario), traces_(traces) {}

  bool operator()(const std::string& name) const {
    if (name.find(run_topics::variable_part) != std::string::npos) return true;
    for (const std::string_view events : {"contacts/", "limits/", "events/", "controller_results/"})
      if (name.starts_with(events)) return true;
    const std::vector<std::string> segments = segments_of(name);
    const auto is_named = [&](const ScenarioBody& body) { return body.name == segments[0]; };
    const auto body = std::ranges::find_if(scenario_.bodies, is_named);
    if (body == scenario_.bodies.end() || segments.size() < 3) return false;
    return has_controller(*body, segments[1]) ? is_of_controller(*body->model, segments)
                                              : is_of_body(*body->model, segments);
  }

 private:
  /// BODY/OWNER/...: joints and links are always recorded, or never; devices may be off.
  bool is_of_body(const Model& model, const std::vector<std::string>& segments) const {
    const Device* device = find_device(model, segments[1]);
    if (!device) return false;
    const bool has_several_channels = std::holds_alternative<Camera>(device->kind);
    return has_several_channels || has_link_or_joint(model, segments[1]) || !is_recorded(segments, 2);
  }
  /// BODY/CONTROLLER/SIDE/OWNER/...: a controller selects its inputs and outputs while it runs.
  bool is_of_controller(const Model& model, const std::vector<std::string>& segments) const {
    if (segments[2] != "input" && segments[2] != "output" && segments[2] != "acted") return false;
    if (segments.size() < 5) return segments.size() == 4;
    const bool is_device = find_device(model, segments[3]) != nullptr;
    if (is_device || segments[4] == "contacts") return true;
    return has_link_or_joint(model, segments[3]) && !is_recorded(segments, 4);
  }
  /// True if a trace has a series that begins with so many of the segments.
  bool is_recorded(const std::vector<std::string>& segments, std::size_t count) const {
    std::string prefix;
    for (std::size_t i = 0; i < count; ++i) prefix += segments[i] + "/";
    return std::ranges::any_of(traces_, [&](const Trace* trace) {
      const auto at = trace->series().lower_bound(prefix);
      return at != trace->series().end() && at->first.starts_with(prefix);
    });
  }

  const Scenario& scenario_;
  std::span<const Trace* const> traces_;
};

bool has_series(std::span<const Trace* const> traces, const std::string& name) {
  return std::ranges::any_of(traces, [&](const Trace* trace) { return trace->find_series(name).has_value(); });
}

Diagnostic unknown(const Place& place, const std::string& name, std::span<const Trace* const> traces) {
  const std::string nearest = traces.empty() ? "" : traces.back()->nearest_series(name);
  return at(place, error(fmt::format("no run of this scenario has a series '{}'", name),
                         nearest.empty() ? "" : "the nearest are " + nearest));
}

/// True if a run may have a series that an expression names, and that no trace has.
bool may_have_missing_names(const Expectation& e, std::span<const Trace* const> traces, const Possible& is_possible) {
  const auto is_there = [&](const std::string& pattern) {
    return std::ranges::any_of(traces, [&](const Trace* trace) {
      return std::ranges::any_of(trace->series(), [&](const auto& series) { return matches(pattern, series.first); });
    });
  };
  return std::ranges::any_of(e.names, [&](const std::string& pattern) {
    return !is_pattern(pattern) && !is_there(pattern) && !is_there("*/" + pattern) && is_possible(pattern);
  });
}

/// A mistake of an expression that each trace shows; none if a trace shows none.
std::optional<Diagnostic> mistake_in_all(const Expectation& e, std::span<const Trace* const> traces) {
  std::optional<Diagnostic> mistake;
  for (const Trace* trace : traces) {
    mistake = mistake_in(e, *trace);
    if (!mistake) break;
  }
  return mistake;
}

}  // namespace

Diagnostics unknown_series(const Scenario& scenario, std::span<const Trace* const> traces) {
  const Possible is_possible(scenario, traces);
  Diagnostics errors;
  for (const ToleranceRule& rule : scenario.tolerances)
    if (!is_pattern(rule.channel) && !unmatched_rules({rule}, traces).empty() && !is_possible(rule.channel))
      errors.push_back(unknown(rule.place, rule.channel, traces));
  for (const Expectation& e : scenario.expectations)
    if (e.subject == Expectation::Subject::series && !is_pattern(e.pattern) && !has_series(traces, e.pattern) &&
        !is_possible(e.pattern))
      errors.push_back(unknown(e.place, e.pattern, traces));
  for (const Expectation& e : scenario.expectations)
    if (auto mistake = mistake_in_all(e, traces); mistake && !may_have_missing_names(e, traces, is_possible))
      errors.push_back(*std::move(mistake));
  return errors;
}

namespace {

/// True if an expectation may have found no series.
bool misses_a_series(const std::vector<ExpectationResult>& results) {
  return std::ranges::any_of(results, [](const ExpectationResult& result) {
    return result.problem ||
           (result.expectation.subject == Expectation::Subject::series && !result.holds && result.series.empty());
  });
}

/// True if the check has told that an exact name in `tolerances` applies to nothing.
bool misses_a_channel(const Scenario& scenario, const CheckReport& report) {
  std::vector<std::string> told = report.remarks;
  if (report.comparison)
    for (const Diagnostic& warning : report.comparison->warnings) told.push_back(to_string(warning));
  return std::ranges::any_of(scenario.tolerances, [&told](const ToleranceRule& rule) {
    return !is_pattern(rule.channel) && std::ranges::count(told, to_string(applies_to_nothing(rule))) > 0;
  });
}

}  // namespace

Result<void> refuse_unknown_series(const Scenario& scenario, const CheckReport& report,
                                   const std::vector<fs::path>& recordings) {
  if (report.run && report.run->ending()) return {};
  if (!misses_a_series(report.expectations) && !misses_a_channel(scenario, report)) return {};
  std::vector<Trace> traces;
  for (const fs::path& recording : recordings) {
    std::error_code ignored;
    if (!fs::exists(recording, ignored)) continue;
    auto trace = REHEARSE_TRY(Trace::load_in_pieces(recording, [](const Trace&) {}));
    traces.push_back(std::move(trace));
  }
  std::vector<const Trace*> pointers;
  for (const Trace& trace : traces) pointers.push_back(&trace);
  Diagnostics errors = unknown_series(scenario, pointers);
  return errors.empty() ? Result<void>() : Result<void>(std::move(errors));
}

}  // namespace rehearse
