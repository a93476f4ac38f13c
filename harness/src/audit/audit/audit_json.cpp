// The results of an audit as JSON.
#include <rehearse/audit.h>

#include <algorithm>

#include "core/compare/report_json.h"

namespace rehearse {
namespace {

using AuditJson = nlohmann::ordered_json;

AuditJson object_of(const FactorResult& result) {
  return {{"factor", to_string(result.factor)},
          {"state", !result.not_varied.empty() ? "not varied"
                    : result.first             ? "differs"
                                               : "same"},
          {"replays", result.replays},
          {"why_not", result.not_varied.empty() ? AuditJson(nullptr) : AuditJson(result.not_varied)},
          {"first", json_of(result.first)}};
}

AuditJson object_of(const AuditedCall& call) {
  return {{"source", call.source}, {"function", call.function},          {"phase", call.phase},
          {"place", call.place},   {"first_tick", call.first_tick},      {"last_tick", call.last_tick},
          {"count", call.count},   {"reached", to_string(call.reached)}, {"note", call.note}};
}

AuditJson object_of(const AuditedCode& code) {
  return {{"kind", code.kind},
          {"count", code.count},
          {"function", code.function},
          {"place", code.place},
          {"sentence", code.sentence}};
}

AuditJson object_of(const AuditedCost& cost) {
  return {{"cost", cost.cost},           {"function", cost.function}, {"phase", cost.phase},
          {"place", cost.place},         {"callers", cost.callers},   {"first_tick", cost.first_tick},
          {"last_tick", cost.last_tick}, {"count", cost.count},       {"breaks_realtime", cost.breaks_realtime()}};
}

AuditJson object_of(const InstructionCounts::Call& call) {
  return {{"tick", call.tick}, {"instructions", call.instructions}};
}

AuditJson object_of(const InstructionCounts::Line& line) {
  return {{"function", line.function}, {"line", line.line}, {"instructions", line.instructions}};
}

AuditJson object_of(const ControllerAudit& controller);

template <class T>
AuditJson json_array(const std::vector<T>& items) {
  AuditJson list = AuditJson::array();
  for (const T& item : items) list.push_back(object_of(item));
  return list;
}

AuditJson object_of(const InstructionCounts& counts) {
  return {{"median", counts.median()},
          {"most", object_of(counts.most)},
          {"lines", json_array(counts.lines)},
          {"calls", json_array(counts.calls)}};
}

AuditJson object_of(const ControllerAudit& controller) {
  return {{"controller", controller.controller},
          {"deterministic", controller.deterministic},
          {"reason", controller.reason.empty() ? AuditJson(nullptr) : AuditJson(controller.reason)},
          {"depends_on", controller.depends_on ? AuditJson(to_string(*controller.depends_on)) : AuditJson(nullptr)},
          {"first", json_of(controller.first)},
          {"factors", json_array(controller.factors)},
          {"calls", json_array(controller.calls)},
          {"rests_on", controller.rests_on},
          {"costs", json_array(controller.costs)},
          {"page_faults",
           {{"total", controller.page_faults.total},
            {"ticks", controller.page_faults.ticks},
            {"first_tick", controller.page_faults.first_tick < 0 ? AuditJson(nullptr)
                                                                 : AuditJson(controller.page_faults.first_tick)}}},
          {"instructions", controller.instructions ? object_of(*controller.instructions) : AuditJson(nullptr)},
          {"library", {{"file", controller.library.string()}, {"findings", json_array(controller.code)}}}};
}

AuditJson object_of(const TriedOrders& orders) {
  AuditJson exchanges = AuditJson::array();
  for (const auto& [runs, before] : orders.exchanges) exchanges.push_back({{"runs", runs}, {"before", before}});
  return {{"tried", orders.tried},
          {"places", orders.places},
          {"threads", orders.threads},
          {"first", json_of(orders.first)},
          {"exchanges", exchanges},
          {"file", orders.file.empty() ? AuditJson(nullptr) : AuditJson(orders.file.string())}};
}

}  // namespace

std::string to_json(const AuditReport& report) {
  AuditJson object{{"verdict", report.verdict},
                   {"deterministic", report.deterministic},
                   {"realtime_safe", report.realtime_safe ? AuditJson(*report.realtime_safe) : AuditJson(nullptr)}};
  auto shown = std::ranges::find_if(report.controllers,
                                    [](const ControllerAudit& controller) { return !controller.deterministic; });
  if (shown == report.controllers.end()) shown = report.controllers.begin();
  const AuditJson first = shown == report.controllers.end() ? AuditJson::object() : object_of(*shown);
  for (const char* key : {"first", "depends_on", "rests_on", "factors", "calls", "library"})
    object[key] = first.value(key, AuditJson());
  object["controllers"] = json_array(report.controllers);
  object["failure"] = report.failure ? AuditJson(report.failure->message) : AuditJson(nullptr);
  object["controller_refused"] = report.controller_refused;
  object["memory_errors"] = report.memory_errors;
  object["ticks"] = report.ticks;
  object["commands"] = report.commands;
  object["replays"] = report.replays;
  object["orders"] = report.orders ? object_of(*report.orders) : AuditJson(nullptr);
  object["remarks"] = AuditJson::array();
  for (const Diagnostic& remark : report.remarks)
    object["remarks"].push_back({{"severity", to_string(remark.severity)}, {"message", remark.message}});
  return text_of(object);
}

}  // namespace rehearse
