#include <fmt/format.h>
#include <rehearse/cdr.h>
#include <rehearse/messages.h>

#include <algorithm>

#include "base/glob.h"
#include "core/expression/joint_series.h"
#include "core/expression/name_search.h"
#include "core/kinds/channel_name.h"
#include "core/mcap/whole_input.h"
#include "core/scenario/joint_limit.h"
#include "core/scenario/trace_scenario.h"
#include "core/trace/run_facts.h"
#include "stepped_trace_impl.h"
#include "viewing/export/picture_file.h"

namespace rehearse {
namespace {

std::vector<std::string> all_links(const Scenario& scenario) {
  std::vector<std::string> links;
  for (const ScenarioBody& body : scenario.bodies)
    for (const Link& link : body.model->links) links.push_back(body.name + "/" + link.name);
  return links;
}

std::optional<std::uint16_t> channel_of(const mcap::Reader& reader, std::string_view topic) {
  for (const auto& [id, channel] : reader.channels())
    if (channel.topic == topic) return id;
  return std::nullopt;
}

}  // namespace

SteppedTrace::Impl::Impl(std::unique_ptr<MessageFinder> finder, Scenario scenario)
    : finder_(std::move(finder)),
      scenario_(std::move(scenario)),
      recorded_(*finder_),
      events_(channel_of(finder_->reader(), run_topics::events)),
      contact_changes_(channel_of(finder_->reader(), run_topics::contact_changes)),
      contacts_(*finder_, contact_changes_, all_links(scenario_)) {}

/// Finds the ticks from the first message on /tick to the last, without the state after the last step.
Result<void> SteppedTrace::Impl::find_ticks() {
  const mcap::Reader& reader = finder_->reader();
  const auto channel = channel_of(reader, run_topics::tick);
  const Diagnostic nothing = error_in(reader.name(), "it has no ticks: nothing of the run was recorded");
  if (!channel) return nothing;
  const auto number = [](const std::optional<MessageFinder::Found>& found) -> std::optional<std::int64_t> {
    msg::Tick tick;
    if (!found) return std::nullopt;
    CdrReader cdr(found->data);
    return msg::decode(cdr, tick) ? std::optional(tick.tick) : std::nullopt;
  };
  const auto found = finder_->next(*channel, 0);
  const auto first = number(found), last = number(finder_->latest(*channel, RecordedTicks::never));
  if (!first || !last) {
    if (!finder_->damage().empty()) return finder_->damage();
    if (!reader.damage().empty()) return mcap::with_recover_hint(reader.damage());
    return nothing;
  }
  if (found->time != ns(*first))
    return error_in(reader.name(), fmt::format("its tick {} isn't at the time of that tick", *first),
                    "a recording keeps the times of the simulation");
  first_tick_ = *first;
  last_tick_ = *last;
  const auto outcome = RunFacts::of(reader).outcome;
  if (outcome && outcome->ticks) last_tick_ = std::min(last_tick_, *outcome->ticks - 1);
  if (last_tick_ < first_tick_) return nothing;
  if (first_tick_ > 1 && contacts_.is_recorded()) {  // tick 1 has the pairs that touch from the beginning
    Diagnostic& remark = remarks_.emplace_back(warning(fmt::format(
        "it begins at tick {}: it lacks earlier contacts, and has only later changes of contact", first_tick_)));
    remark.file = reader.name();
  }
  return {};
}

Result<void> SteppedTrace::Impl::replay(const SteppingOptions& options) {
  if (options.last_tick && (*options.last_tick > last_tick_ || *options.last_tick < first_tick_)) {
    const bool is_late = *options.last_tick > last_tick_;
    const std::int64_t nearest = is_late ? last_tick_ : first_tick_;
    return error_in(finder_->reader().name(),
                    fmt::format("there is no tick {}: the {} is {} ({:.10g} s)", *options.last_tick,
                                is_late ? "last" : "first", nearest, time_of(nearest, scenario_.time_step)));
  }
  std::optional<double> until;
  std::optional<std::int64_t> last = options.last_tick;
  if (!last && options.last_time) last = std::llround(std::floor(*options.last_time / scenario_.time_step + 1e-6));
  if (last) until = (static_cast<double>(std::max<std::int64_t>(0, *last)) + 0.5) * scenario_.time_step;
  replayed_ = ReplayedOutputs::make(finder_->reader(), scenario_, options, until);
  const bool asked_for_it = !options.libraries.empty();
  if (asked_for_it && !replayed_->last_tick() && !replayed_->failure()) {
    Diagnostics errors = replayed_->remarks();
    if (errors.size() > 1) errors.pop_back();  // removes the hint that recorded data can be viewed
    for (Diagnostic& finding : errors) finding.severity = Severity::error;
    if (!errors.empty()) return errors;
  }
  const auto add = [this](const Diagnostic& remark) {
    const bool known =
        std::ranges::any_of(remarks_, [&](const Diagnostic& other) { return other.message == remark.message; });
    if (!known) remarks_.push_back(remark);
  };
  for (const Diagnostic& remark : replayed_->remarks()) add(remark);
  if (MessageFinder* variables = replayed_->variables()) recorded_.add_replayed(*variables);
  return {};
}

const std::vector<Divergence>& SteppedTrace::Impl::differences(std::int64_t tick) {
  KnownDifferences* oldest = &known_differences_.front();
  for (KnownDifferences& known : known_differences_) {
    if (known.tick == tick) {
      known.used = ++uses_;
      return known.all;
    }
    if (known.used < oldest->used) oldest = &known;
  }
  *oldest = {tick, ++uses_, replayed_->differences(ns(tick))};
  return oldest->all;
}

SteppedTrace::SteppedTrace(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SteppedTrace::~SteppedTrace() = default;

Result<std::unique_ptr<SteppedTrace>> SteppedTrace::open(const std::filesystem::path& file,
                                                         const SteppingOptions& options) {
  auto finder = REHEARSE_TRY(MessageFinder::open(file));
  auto scenario = REHEARSE_TRY(scenario_of(finder->reader()));
  auto impl = std::make_unique<Impl>(std::move(finder), std::move(scenario));
  append_as_warnings(mcap::with_recover_hint(impl->finder_->reader().damage()), impl->remarks_);
  REHEARSE_TRY(impl->find_ticks());
  REHEARSE_TRY(impl->replay(options));
  return std::unique_ptr<SteppedTrace>(new SteppedTrace(std::move(impl)));
}

const std::string& SteppedTrace::file() const { return impl_->finder_->reader().name(); }
const Diagnostics& SteppedTrace::remarks() const { return impl_->remarks_; }
std::int64_t SteppedTrace::first_tick() const { return impl_->first_tick_; }
std::int64_t SteppedTrace::last_tick() const { return impl_->last_tick_; }
std::optional<std::int64_t> SteppedTrace::last_replayed() const { return impl_->replayed_->last_tick(); }
const std::optional<Diagnostic>& SteppedTrace::failure() const { return impl_->replayed_->failure(); }
bool SteppedTrace::differs() const { return impl_->replayed_->differs(); }
std::optional<std::int64_t> SteppedTrace::first_difference() const {
  const std::uint64_t begin = impl_->ns(first_tick());
  if (impl_->replayed_->differs_at(begin)) return first_tick();
  const auto time = impl_->replayed_->difference_beside(begin, Direction::forwards);
  return time ? std::optional(impl_->tick_of(*time)) : std::nullopt;
}
double SteppedTrace::time_at(std::int64_t tick) const { return time_of(tick, impl_->scenario_.time_step); }

std::int64_t SteppedTrace::tick_at(double time) const {
  // A time that is written with a few digits means the tick at this time, not the one before.
  return static_cast<std::int64_t>(std::floor(time / impl_->scenario_.time_step + 1e-6));
}

const std::vector<std::string>& SteppedTrace::series_names() { return impl_->recorded_.names(); }

const std::string& SteppedTrace::series_name(std::size_t series) const {
  const SeriesPlace place = series_place(series);
  return impl_->recorded_.channel(place.channel).columns[place.column].series;
}

std::string SteppedTrace::series_unit(std::size_t series) const {
  const SeriesPlace place = series_place(series);
  const TraceChannel& channel = impl_->recorded_.channel(place.channel);
  return unit_of(channel.metadata, channel.columns[place.column].element);
}

Result<std::size_t> SteppedTrace::find_series(std::string_view name) {
  RecordedTicks& recorded = impl_->recorded_;
  auto found = find_name(name, recorded.names(), "series");
  const auto is_unknown = [&] { return !found && found.errors().front().message.starts_with("there is no"); };
  if (is_unknown()) {
    recorded.learn_all();
    found = find_name(name, recorded.names(), "series");
  }
  if (!found) return found.errors();
  return series_id(recorded.series().find(recorded.names()[*found])->second);
}

Result<std::size_t> SteppedTrace::find_joint_series(std::string_view joint, std::string_view quantity,
                                                    bool of_command) {
  RecordedTicks& recorded = impl_->recorded_;
  const auto found = REHEARSE_TRY(find_joint_name(joint, quantity, of_command, recorded.names()));
  return series_id(recorded.series().find(recorded.names()[found])->second);
}

Result<JointLimit> SteppedTrace::find_limit(std::string_view joint, std::string_view limit) {
  return joint_limit(impl_->scenario_, joint, limit);
}

double SteppedTrace::value_at(std::size_t series, double time, std::int64_t tick) {
  const std::int64_t then = tick_at(time);
  return then <= tick ? value(series, then, CommandSide::recorded) : std::nan("");
}

Result<std::vector<std::size_t>> SteppedTrace::find_all_series(std::string_view pattern) {
  std::vector<std::size_t> all;
  if (pattern.find('*') == std::string_view::npos) {
    const auto one = REHEARSE_TRY(find_series(pattern));
    return std::vector{one};
  }
  for (const auto& [name, place] : impl_->recorded_.series())
    if (matches(pattern, name) || matches("*/" + std::string(pattern), name)) all.push_back(series_id(place));
  if (all.empty()) return error(fmt::format("no series matches '{}'", pattern), "rehearse info lists the channels");
  return all;
}

bool SteppedTrace::is_replayed(std::size_t series) const {
  const std::size_t channel = series_place(series).channel;
  return last_replayed() &&
         (impl_->is_command(impl_->recorded_.channel(channel).topic) || impl_->recorded_.has_replayed_rows(channel));
}

Result<std::vector<std::size_t>> SteppedTrace::find_links(std::string_view name) {
  ContactHistory& contacts = impl_->contacts_;
  if (!contacts.is_recorded())
    return error("the recording has no contacts",
                 "recordings of this version have contacts; replays of robots' logs have none");
  std::vector<std::size_t> of_body;
  for (std::size_t i = 0; i < contacts.links().size(); ++i)
    if (contacts.links()[i].starts_with(std::string(name) + "/")) of_body.push_back(i);
  if (!of_body.empty()) return of_body;
  const auto found = REHEARSE_TRY(find_name(name, contacts.links(), "link"));
  return std::vector{found};
}

double SteppedTrace::value(std::size_t series, std::int64_t tick, CommandSide side) {
  const SeriesPlace place = series_place(series);
  const bool of_replay = side == CommandSide::replayed || !impl_->recorded_.is_recorded(place.channel);
  if (of_replay && (!last_replayed() || tick > *last_replayed())) return std::nan("");
  if (side == CommandSide::replayed) {
    const TraceChannel& channel = impl_->recorded_.channel(place.channel);
    if (impl_->recorded_.has_replayed_rows(place.channel)) {
      const RecordedTicks::Row* row = impl_->recorded_.replayed_row(place.channel, impl_->ns(tick));
      return row ? impl_->recorded_.number(place.channel, place.column, *row) : std::nan("");
    }
    for (const Divergence& found : impl_->differences(tick))
      if (found.channel == channel.topic && found.element == channel.columns[place.column].element) return found.actual;
  }
  const RecordedTicks::Row* row = impl_->recorded_.row(place.channel, impl_->ns(tick));
  return row ? impl_->recorded_.number(place.channel, place.column, *row) : std::nan("");
}

bool SteppedTrace::touching(const std::vector<std::size_t>& links, const std::vector<std::size_t>& others,
                            std::int64_t tick) {
  return impl_->contacts_.touching(links, others, impl_->ns(tick));
}

bool SteppedTrace::differs_at(std::int64_t tick) { return impl_->replayed_->differs_at(impl_->ns(tick)); }

bool SteppedTrace::said(std::string_view pattern, std::int64_t tick) {
  const auto all = messages(tick);
  return std::ranges::any_of(all, [&](const ViewMessage& message) { return matches(pattern, message.text); });
}

bool SteppedTrace::happened(std::string_view pattern, std::int64_t tick) {
  const auto all = messages(tick);
  return std::ranges::any_of(all, [&](const ViewMessage& message) {
    return matches(pattern, fmt::format("{} {}: {}", message.severity, message.source, message.text));
  });
}

std::vector<std::string> SteppedTrace::picture_topics() const {
  std::vector<std::string> topics;
  for (std::size_t i = 0; i < impl_->recorded_.channels(); ++i) {
    const TraceChannel& channel = impl_->recorded_.channel(i);
    if (is_picture_type(channel.type)) topics.push_back(channel.topic);
  }
  return topics;
}

Result<SteppedTrace::Picture> SteppedTrace::picture(std::string_view camera, std::int64_t tick) {
  const std::vector<std::string> topics = picture_topics();
  if (topics.empty()) return error("the recording has no pictures", "record it without --no-frames, with cameras");
  std::vector<std::string> names;  // names of the camera, and names with the kind of picture
  for (const std::string& topic : topics) {
    const bool shows_colors = ChannelName::parse(topic).kind == ChannelKind::image;
    names.push_back(topic.substr(1, topic.size() - 1 - (shows_colors ? 6 : 0)));
  }
  if (camera.empty() && names.size() > 1)
    return error(fmt::format("there are {} cameras", names.size()), fmt::format("one of {}", fmt::join(names, ", ")));
  const auto chosen =
      REHEARSE_TRY(camera.empty() ? Result<std::size_t>(std::size_t{0}) : find_name(camera, names, "camera"));
  const mcap::Reader& reader = impl_->finder_->reader();
  const auto channel = channel_of(reader, topics[chosen]);
  const auto found = impl_->finder_->latest(*channel, impl_->ns(tick));
  if (!found) return error(fmt::format("{} has no picture up to tick {}", names[chosen], tick));
  const mcap::Schema* schema = reader.schema_of(reader.channels().at(*channel));
  auto file = REHEARSE_TRY(picture_file(schema->name, found->data));
  return Picture{impl_->tick_of(found->time), topics[chosen], file.extension, std::move(file.bytes)};
}

}  // namespace rehearse
