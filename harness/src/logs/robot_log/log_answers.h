// Results of a log's replay as answers between processes (core/guard/answer.h). Internal.
#pragma once

#include "core/compare/difference_answer.h"
#include "core/host/control_times_answer.h"
#include "log_memory.h"
#include "log_replay.h"

namespace rehearse {

void each_member(Passed<CommandRecord> auto& value, auto& each) { value.each_part(each); }

void each_gap(auto& value, auto& each) {
  each(value.worst_age), each(value.worst_age_at), each(value.gaps), each(value.ticks_in_gaps);
}

/// Its members can't be bound, because it has a base with members; likewise below.
void each_member(Passed<SilentJoint> auto& value, auto& each) { each_gap(value, each), each(value.joint); }

void each_member(Passed<LogStranger> auto& value, auto& each) {
  auto& [name, first_at] = value;
  each(name), each(first_at);
}

void each_member(Passed<LogUnreadable> auto& value, auto& each) {
  auto& [reason, messages, first_at] = value;
  each(reason), each(messages), each(first_at);
}

void each_member(Passed<LogClockReport> auto& value, auto& each) {
  auto& [offset, drift, reference, least_delay, is_stated, steps] = value;
  each(offset), each(drift), each(reference), each(least_delay), each(is_stated), each(steps);
}

void each_member(Passed<LogTopicReport> auto& value, auto& each) {
  each_gap(value, each);
  each(value.topic), each(value.type), each(value.use), each(value.messages), each(value.used), each(value.skipped);
  each(value.out_of_order), each(value.same_stamp), each(value.backwards), each(value.unreadable);
  each(value.unreadable_for), each(value.silent_joints), each(value.strangers), each(value.twins), each(value.clock),
      each(value.rate), each(value.longest_gap);
  each(value.longest_gap_at), each(value.ticks_without);
}

void each_member(Passed<LogTickReport> auto& value, auto& each) {
  auto& [topic, is_grid, interval, rate, drift, jitter, phase, missing, latency, measured_by] = value;
  each(topic), each(is_grid), each(interval), each(rate), each(drift), each(jitter), each(phase), each(missing);
  each(latency), each(measured_by);
}

void each_member(Passed<LogTiming> auto& value, auto& each) {
  auto& [shift, ticks, different] = value;
  each(shift), each(ticks), each(different);
}

void each_member(Passed<LogCause> auto& value, auto& each) {
  auto& [lines, meaning, ticks, different] = value;
  each(lines), each(meaning), each(ticks), each(different);
}

void each_member(Passed<LogRest> auto& value, auto& each) {
  auto& [series, unit, from, ticks, low, high, range] = value;
  each(series), each(unit), each(from), each(ticks), each(low), each(high), each(range);
}

void each_member(Passed<LogStretches> auto& value, auto& each) {
  each_difference(value, each);
  each(value.memory), each(value.compared), each(value.different), each(value.beyond_at);
  each(value.first_uncertain), each(value.rest), each(value.is_no_state);
}

void each_member(Passed<JoystickMove> auto& value, auto& each) {
  auto& [at, axes, buttons] = value;
  each(at), each(axes), each(buttons);
}

void each_member(Passed<LogStart::Root> auto& value, auto& each) {
  auto& [position, rotation] = value;
  for (auto& number : position) each(number);
  for (auto& number : rotation.coeffs()) each(number);
}

void each_member(Passed<LogStart> auto& value, auto& each) {
  auto& [root, joints, has_joystick, joystick, moves_left_out] = value;
  each(root), each(joints), each(has_joystick), each(joystick), each(moves_left_out);
}

void each_member(Passed<MappedController> auto& value, auto& each) {
  auto& [name, options, delay] = value;
  each(name), each(options), each(delay);
}

void each_member(Passed<LogReplayReport> auto& value, auto& each) {
  each_difference(value, each);
  each(value.ticks), each(value.duration), each(value.start), each(value.begins), each(value.log_hash);
  each(value.topics), each(value.control_times), each(value.has_commands), each(value.ticks_compared);
  each(value.ticks_different), each(value.ticks_beyond), each(value.beyond_at), each(value.ticks_without_inputs);
  each(value.inputs_end), each(value.ticks_without_message), each(value.ticks_without_command);
  each(value.ticks_in_doubt), each(value.timing), each(value.certain), each(value.cause), each(value.tick);
  each(value.begin), each(value.time_step), each(value.body), each(value.controller), each(value.channels);
  each(value.pictures), each(value.bytes), each(value.failure), each(value.controller_refused), each(value.remarks);
  each(value.after_restarts), each(value.trace);
}

}  // namespace rehearse
