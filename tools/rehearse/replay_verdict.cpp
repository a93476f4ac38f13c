#include "replay_verdict.h"

#include <fmt/format.h>

#include "base/text.h"
#include "control_times.h"
#include "core/check/check_json.h"

namespace rehearse::tool {

bool replay_holds(const ReplayReport& report) {
  return (report.equal() || report.is_allowed() || report.is_rounding()) && report.values > 0;
}

std::string replay_verdict(const ReplayReport& report) {
  if (report.is_rounding())
    return fmt::format("within its tolerance: {}; {}", headline(report), report.other_mathematics);
  if (report.failure) return "failed: " + report.failure->message;
  std::string files;
  for (const std::string& change : report.changed_files) files += "; " + change;
  if (report.first)
    return headline(report, report.is_allowed() ? "the rules for commands allow the differences: " : "differs: ") +
           (report.explanation.empty() ? "" : "; " + report.explanation) + files;
  if (report.values == 0) return "nothing was compared: no controller commanded anything in that time";
  return fmt::format("equal bit for bit: {}, {}", count_text(report.ticks, "tick"),
                     count_text(report.values, "commanded number"));
}

Json replay_json(const ReplayReport& report, const std::vector<std::string>& notes) {
  Json object{{"verdict", replay_verdict(report)},
              {"equal", report.equal() && report.values > 0},
              {"within", replay_holds(report)},
              {"explanation", report.explanation}};
  object.update(json_of(report));
  object.update({{"words",
                  {{"lines", report.words.lines},
                   {"variables", report.words.variables},
                   {"different", report.words.different},
                   {"first", json_of(report.words.first)}}},
                 {"failure", report.failure ? Json(report.failure->message) : Json(nullptr)},
                 {"changed_files", report.changed_files},
                 {"controller_refused", report.controller_refused},
                 {"control_times", json_of(report.control_times)},
                 {"remarks", json_of_remarks(report.remarks, notes)}});
  return object;
}

}  // namespace rehearse::tool
