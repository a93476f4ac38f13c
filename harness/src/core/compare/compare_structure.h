// Comparers of what is not a value: ticks, inputs that are read, channels of one run only, events. Internal.
#pragma once

#include <rehearse/compare.h>

#include <functional>
#include <string>
#include <vector>

#include "compared_traces.h"

namespace rehearse {

/// Sets traces.end: everything is compared up to the end of the shorter run. Reports runs of different length, and
/// ticks that only one of them has.
void compare_ticks(ComparedTraces& traces, ChannelComparison& result);
/// Sets traces.other_inputs, and returns their names as Comparison::other_inputs has them.
std::vector<std::string> find_other_inputs(ComparedTraces& traces);
/// "the controller reads other inputs: + KNEE/dq of SR1/Walker"
std::string other_inputs_sentence(const std::vector<std::string>& names);
/// Reports the channels that only one trace has, with one entry for each body, controller, device or channel. `takes`:
/// true for channels that are compared.
void compare_lone_channels(const ComparedTraces& traces, const std::function<bool(const TraceChannel&)>& takes,
                           const AddChannel& add, std::vector<std::string>& remarks);

/// Compares the sequences of events, and sets traces.blanked.
void compare_events(ComparedTraces& traces, const AddChannel& add, std::vector<EventDifference>& differences);

}  // namespace rehearse
