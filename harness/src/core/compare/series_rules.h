// The rules of tolerances for a channel and its columns. Internal.
#pragma once

#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// The index of the element's column, or columns.size().
std::size_t column_of(const TraceChannel& channel, std::string_view element);

/// The name of a column in tolerance rules. A transform is named by its frame, like the pose of a link.
const std::string& series_of(const TraceChannel& channel, const TraceColumn& column);

/// The tolerance of a column by the rules and its unit; none for integers, which are exact.
Tolerance column_tolerance(const TraceChannel& channel, std::size_t column, const std::vector<ToleranceRule>& rules);

/// The name in tolerance rules for a channel without columns: its topic without the first slash.
std::string_view series_of(const TraceChannel& channel);

/// True for the results of control(), which are compared as events.
bool is_result_of_control(const TraceChannel& channel, std::string_view element);

bool is_picture(const TraceChannel& channel);

/// The tolerance of a camera's colours or distances.
Tolerance picture_tolerance(const TraceChannel& channel, const std::vector<ToleranceRule>& rules);

/// The warning of a rule that matches nothing.
Diagnostic applies_to_nothing(const ToleranceRule& rule);
/// The warnings of the rules that match nothing in any of the traces.
Diagnostics unmatched_rules(const std::vector<ToleranceRule>& rules, std::span<const Trace* const> traces);

}  // namespace rehearse
