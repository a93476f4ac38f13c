#include "log_survey.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include "core/compare/series_scale.h"
#include "core/ros2msg/message_format.h"
#include "joint_messages.h"
#include "log_feed.h"
#include "message_reader.h"

namespace rehearse {
namespace {

/// Messages of joints are decoded until this number of messages contained no new joint or quantity.
constexpr std::int64_t joint_messages = 1000;

/// The joints and quantities in the messages of a source: JointStates, or arrays of commands.
class JointSurvey {
 public:
  JointSurvey(const MappedSource& mapped, const LogMap& map, const Model& model, const ros2msg::Schema& schema)
      : renamed_(mapped.joints ? mapped.joints->names : mapped.commands->names),
        differentiates_(mapped.joints && mapped.joints->differentiate),
        reader_(schema, mapped.joints ? JointRole::measured : JointRole::commanded),
        names_(renamed_, model) {
    if (mapped.commands && mapped.commands->is_array) array_.emplace(map, model, schema);
  }

  void look(mcap::Bytes payload, std::int64_t time, SourceSurvey& found) {
    if (idle_ >= joint_messages && unseen_ == 0) return;
    ++idle_;
    if (array_) return look_at_array(payload, found);
    const auto read = reader_.read(payload);
    if (!read) return fail(read.errors()[0], found);
    const JointArrays* state = *read;
    any_read_ = true;
    found.unreadable.reset();
    const std::vector<JointRename>& joints = names_.find(state->names());
    if (state->names() != last_names_) note_names(state->names(), joints, found);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (joints[i].joint < 0) continue;
      const auto [known, is_new] = found.joints.emplace(joints[i].joint, GivenJoint());
      const GivenJoint before = known->second;
      GivenJoint& given = known->second;
      given.q |= state->position().size() == joints.size();
      if (i < state->position().size()) found.positions[joints[i].joint].add(state->position()[i] * joints[i].scale);
      given.dq |= state->velocity().size() == joints.size() || (differentiates_ && given.q);
      given.u |= state->effort().size() == joints.size();
      if (!is_new && before.q == given.q && before.dq == given.dq && before.u == given.u) continue;
      found.complete = time;
      idle_ = 0;
    }
  }

 private:
  void fail(Diagnostic reason, SourceSurvey& found) {
    if (!any_read_ && !found.unreadable) found.unreadable = std::move(reason);
  }

  void look_at_array(mcap::Bytes payload, SourceSurvey& found) {
    const auto commanded = array_->read(payload);
    if (!commanded) return fail(commanded.errors()[0], found);
    any_read_ = true;
    found.unreadable.reset();
    idle_ = joint_messages;  // later messages have the same joints
    for (std::size_t id = 0; id < commanded->size(); ++id) {
      const CommandedJoint& joint = (*commanded)[id];
      if (joint.q || joint.dq || joint.u)
        found.joints[static_cast<int>(id)] = {joint.q.has_value(), joint.dq.has_value(), joint.u.has_value()};
    }
  }

  void note_names(const std::vector<std::string>& names, const std::vector<JointRename>& joints, SourceSurvey& found) {
    last_names_ = names;
    std::set<std::string> in_message;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (!in_message.insert(names[i]).second) found.repeated.insert(names[i]);
      found.names.emplace(names[i], joints[i].joint);
    }
    unseen_ = std::ranges::count_if(renamed_,
                                    [&found](const auto& renamed) { return found.names.count(renamed.first) == 0; });
  }

  const std::map<std::string, JointRename>& renamed_;
  const bool differentiates_;
  JointMessages reader_;
  std::optional<CommandReader> array_;
  JointNames names_;
  std::vector<std::string> last_names_;
  bool any_read_ = false;
  std::ptrdiff_t unseen_ = std::ssize(renamed_);  // number of the map's names that no message had
  std::int64_t idle_ = 0;                         // number of messages since the last new joint or quantity
};

/// One source during the survey.
struct Surveyed {
  std::unique_ptr<JointSurvey> joints;
  std::unique_ptr<CommandReader> commands;
  mcap::Location furthest;
  bool any = false;
};

void add_tick(std::int64_t time, LogSurvey& found) {
  if (found.tick_messages.empty() || time > found.tick_messages.back()) found.tick_messages.push_back(time);
}

/// Adds the time from the last message of each input, and of the ticks, to a command.
void add_latencies(std::int64_t time, const std::vector<MappedSource>& sources, LogSurvey& found) {
  if (!found.tick_messages.empty() && time >= found.tick_messages.back())
    found.latencies.add(time - found.tick_messages.back());
  for (std::size_t i = 0; i < sources.size(); ++i) {
    SourceSurvey& source = found.sources[i];
    if (sources[i].is_awaited() && source.first && time >= source.last) source.before_commands.add(time - source.last);
  }
}

void note_timeless(const std::string& reason, const mcap::Message& message, SourceSurvey& found) {
  ++found.without_time;
  const auto same = [&](const LogUnreadable& known) { return known.reason == reason; };
  auto known = std::ranges::find_if(found.timeless, same);
  if (known == found.timeless.end()) {
    const bool has_log_time = message.log_time <= static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
    const std::int64_t time = has_log_time ? static_cast<std::int64_t>(message.log_time) : found.last;
    known = found.timeless.insert(known, {reason, 0, static_cast<double>(time) * 1e-9});
  }
  ++known->messages;
}

bool is_behind(const mcap::Location& a, const mcap::Location& b) {
  return a.record != b.record ? a.record > b.record : a.inside > b.inside;
}

}  // namespace

LogSurvey survey(mcap::Reader& log, const LogMap& map, const Model& model, const std::vector<MappedSource>& sources,
                 LogTimes& times) {
  LogSurvey found;
  found.sources.resize(sources.size());
  std::vector<Surveyed> surveyed(sources.size());
  bool any_time = false;
  times.begin_pass();
  const bool has_relative = std::ranges::any_of(map.tolerances, is_relative);
  const auto look = [&](const mcap::Message& message) {
    const bool is_twin = times.is_twin(message);
    const auto time = times.of(message);
    if (time && !is_twin && map.tick && map.tick->is_on(message.channel->topic)) add_tick(*time, found);
    for (std::size_t i = 0; i < sources.size(); ++i) {
      if (!sources[i].source->is_on(message.channel->topic)) continue;
      SourceSurvey& source = found.sources[i];
      Surveyed& state = surveyed[i];
      if (is_twin) {
        ++source.twins;
        continue;
      }
      ++source.messages;
      if (state.any && is_behind(state.furthest, message.location)) ++source.out_of_order;
      if (!state.any || is_behind(message.location, state.furthest)) state.furthest = message.location;
      state.any = true;
      if (!time) {
        note_timeless(time.errors()[0].message, message, source);
        continue;
      }
      if (source.first && *time < source.last) {  // an earlier time than before: it isn't used
        ++source.backwards;
        continue;
      }
      if (source.first) source.intervals.add(*time - source.last);
      if (!source.first) {
        source.first = source.complete = *time;
        source.first_delay = static_cast<std::int64_t>(message.log_time) - *time;
      }
      source.last = *time;
      source.last_logged = message.log_time;
      if (sources[i].commands) add_latencies(*time, sources, found);
      const std::int64_t late = static_cast<std::int64_t>(message.log_time) - *time;
      found.latest = std::exchange(any_time, true) ? std::max(found.latest, late) : late;
      if (!sources[i].joints && !sources[i].commands) continue;
      if (!state.joints) {
        const mcap::Schema* schema = log.schema_of(*message.channel);
        const auto parsed = ros2msg::schema_of(message.channel->message_encoding, *schema);
        if (!parsed) continue;  // topics_of() has reported it
        state.joints = std::make_unique<JointSurvey>(sources[i], map, model, *parsed);
        if (sources[i].commands) state.commands = std::make_unique<CommandReader>(map, model, *parsed);
      }
      state.joints->look(message.data, *time, source);
      if (!state.commands) continue;
      const bool gives_range = found.ranges.takes_next();
      if (!gives_range && !has_relative) continue;
      auto joints = state.commands->read(message.data);
      if (joints && has_relative) keep_largest(found.largest_commands, *joints);
      if (joints && gives_range) found.ranges.add(*std::move(joints));
    }
    return true;
  };
  found.damage = read_in_order(log, channels_of(log, sources), look);
  return found;
}

}  // namespace rehearse
