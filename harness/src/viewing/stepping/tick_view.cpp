#include <rehearse/cdr.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <array>

#include "core/kinds/channel_name.h"
#include "stepped_trace_impl.h"
#include "viewing/export/picture_file.h"

namespace rehearse {
namespace {

/// False for channels for viewers, of the recording itself, and of constants, which don't change from tick to tick.
bool is_shown(const TraceChannel& channel) {
  constexpr std::array<std::string_view, 3> left_out{msg::TFMessage::type_name, msg::Tick::type_name,
                                                     msg::CameraInfo::type_name};
  return std::ranges::find(left_out, channel.type) == left_out.end();
}

ViewMessage shown(const msg::Event& event, ViewMessage::Where where) {
  return {event.severity, event.source, event.text, where};
}

}  // namespace

void SteppedTrace::Impl::classify(ViewChannel& shown) {
  using Kind = ViewChannel::Kind;
  ChannelName name = ChannelName::parse(shown.topic);
  shown.owner = name.controller.empty() ? name.body : name.label();
  if (name.side == ChannelSide::input) shown.kind = Kind::input;
  if (name.side == ChannelSide::output) shown.kind = Kind::output;
  const bool is_measured = stage_of(name) == Stage::sensors && name.kind != ChannelKind::measured_joints;
  if (name.side == ChannelSide::none && !name.body.empty()) shown.kind = is_measured ? Kind::sensor : Kind::state;
  if (shown.kind != Kind::other) name.side = ChannelSide::none;
  name.body = name.controller = "";
  const std::string rest = name.topic();
  shown.part = rest.substr(std::min<std::size_t>(1, rest.size()));
}

ViewChannel SteppedTrace::Impl::channel_at(std::size_t index, std::int64_t tick, const RecordedTicks::Row& row) {
  const std::vector<std::uint64_t> cells = row.cells;  // the row may become invalid when the row before is read
  const RecordedTicks::Row now{row.time, row.until, 0, cells};
  const RecordedTicks::Row* before = tick > first_tick_ ? recorded_.row(index, ns(tick - 1)) : nullptr;
  const TraceChannel& channel = recorded_.channel(index);
  ViewChannel shown;
  shown.topic = channel.topic;
  classify(shown);
  shown.is_joints = channel.type == msg::JointState::type_name;
  const std::vector<Divergence>* differ = is_command(channel.topic) ? &differences(tick) : nullptr;
  const bool may_have_fewer = channel.type == msg::Contacts::type_name;
  for (std::size_t column = 0; column < channel.columns.size(); ++column) {
    ViewValue value;
    value.element = channel.columns[column].element;
    value.series = channel.columns[column].series;
    value.unit = unit_of(channel.metadata, value.element);
    value.value = recorded_.number(index, column, now);
    if (before) value.before = recorded_.number(index, column, *before);
    const bool was_there = value.before && !std::isnan(*value.before);
    if (may_have_fewer && std::isnan(value.value) && !was_there) continue;
    if (differ) {
      const auto found = std::ranges::find_if(*differ, [&](const Divergence& divergence) {
        return divergence.channel == channel.topic && divergence.element == value.element;
      });
      if (found != differ->end()) {
        value.replayed = found->actual;
        value.ulps = found->ulps;
      }
    }
    if (const RecordedTicks::Row* again = replayed_->last_tick() && tick <= *replayed_->last_tick()
                                              ? recorded_.replayed_row(index, ns(tick))
                                              : nullptr) {
      const double number = recorded_.number(index, column, *again);
      if (!identical(number, value.value)) {
        value.replayed = number;
        value.ulps = ulps_between(number, value.value);
      }
    }
    shown.values.push_back(std::move(value));
  }
  return shown;
}

TickView SteppedTrace::view(std::int64_t tick) {
  REHEARSE_ASSERT(tick >= first_tick() && tick <= last_tick(), "only a tick of the recording can be shown");
  TickView view;
  view.tick = tick;
  view.time = time_at(tick);
  view.is_replayed = last_replayed() && tick <= *last_replayed();
  const std::uint64_t now = impl_->ns(tick);
  for (std::size_t i = 0; i < impl_->recorded_.channels(); ++i) {
    const TraceChannel& channel = impl_->recorded_.channel(i);
    if (is_picture_type(channel.type)) {
      for (const MessageFinder::Found& found : impl_->finder_->at(impl_->recorded_.channel_id(i), now))
        view.pictures.push_back({channel.topic, found.data.size()});
      continue;
    }
    if (!is_shown(channel)) continue;
    const RecordedTicks::Row* row = impl_->recorded_.row(i, now);
    if (row && row->time == now) view.channels.push_back(impl_->channel_at(i, tick, *row));
  }
  view.messages = messages(tick);
  view.contacts = contacts(tick);
  view.threads = threads(tick);
  view.differences = differences(tick);
  return view;
}

std::vector<std::string> SteppedTrace::threads(std::int64_t tick) { return impl_->replayed_->threads(impl_->ns(tick)); }

std::vector<ViewMessage> SteppedTrace::messages(std::int64_t tick) {
  using Where = ViewMessage::Where;
  std::vector<ViewMessage> all;
  const std::uint64_t now = impl_->ns(tick);
  if (impl_->events_) {
    for (const MessageFinder::Found& found : impl_->finder_->at(*impl_->events_, now)) {
      CdrReader reader(found.data);
      msg::Event event;
      if (msg::decode(reader, event)) all.push_back(shown(event, Where::recorded));
    }
  }
  for (const msg::Event& event : impl_->replayed_->events(now)) {
    const auto same = std::ranges::find_if(all, [&](const ViewMessage& message) {
      return message.where == Where::recorded && message.source == event.source && message.text == event.text;
    });
    if (same == all.end()) {
      all.push_back(shown(event, Where::replayed));
    } else {
      same->where = Where::both;
    }
  }
  return all;
}

std::vector<ViewContact> SteppedTrace::contacts(std::int64_t tick) {
  std::vector<ViewContact> all;
  const auto pairs = impl_->contacts_.at(impl_->ns(tick));
  const std::vector<std::string>& links = impl_->contacts_.links();
  for (const ContactHistory::Pair& pair : pairs)
    all.push_back({links[pair.link], links[pair.other], pair.touches, pair.touches && pair.changed});
  return all;
}

std::vector<Divergence> SteppedTrace::differences(std::int64_t tick) { return impl_->differences(tick); }

std::optional<std::int64_t> SteppedTrace::happening(std::int64_t tick, Direction direction) {
  const auto is_nearer = [direction](std::optional<std::uint64_t> time, std::optional<std::uint64_t> than) {
    if (!time || !than) return time.has_value();
    return direction == Direction::forwards ? *time < *than : *time > *than;
  };
  const ReplayedOutputs& replayed = *impl_->replayed_;
  const std::uint64_t now = impl_->ns(tick);
  std::optional<std::uint64_t> nearest = replayed.event_beside(now, direction);
  for (const auto& channel : {impl_->events_, impl_->contact_changes_}) {
    const auto found = channel ? nearest_message(*impl_->finder_, *channel, now, direction) : std::nullopt;
    if (is_nearer(found, nearest)) nearest = found;
  }
  for (auto differs = replayed.difference_beside(now, direction); is_nearer(differs, nearest);
       differs = replayed.difference_beside(*differs, direction)) {
    const std::int64_t at = impl_->tick_of(*differs);
    const bool begins = at == first_tick() || !differs_at(at - 1);
    if (begins) nearest = differs;
  }
  if (!nearest) return std::nullopt;
  const std::int64_t at = impl_->tick_of(*nearest);
  return at >= first_tick() && at <= last_tick() ? std::optional(at) : std::nullopt;
}

bool find_spans(const Expression& expression, SteppedTrace& trace, std::int64_t first, std::int64_t last,
                const std::function<bool(const TickSpanFound&)>& found, const std::function<bool()>& interrupted) {
  std::optional<std::int64_t> begin;
  for (std::int64_t tick = first; tick <= last; ++tick) {
    if (interrupted && interrupted()) return false;
    const bool holds = expression.holds(trace, tick);
    if (holds && !begin) begin = tick;
    if (!holds && begin) {
      if (!found({*begin, tick - 1})) return true;
      begin.reset();
    }
  }
  if (begin) found({*begin, last});
  return true;
}

std::optional<std::int64_t> find_tick(const Expression& expression, SteppedTrace& trace, std::int64_t from,
                                      Direction direction, const std::function<bool()>& interrupted) {
  const int step = direction == Direction::forwards ? 1 : -1;
  bool held = expression.holds(trace, from);
  for (std::int64_t tick = from + step; tick >= trace.first_tick() && tick <= trace.last_tick(); tick += step) {
    if (interrupted && interrupted()) return std::nullopt;
    const bool holds = expression.holds(trace, tick);
    if (holds && !held) return tick;
    held = holds;
  }
  return std::nullopt;
}

}  // namespace rehearse
