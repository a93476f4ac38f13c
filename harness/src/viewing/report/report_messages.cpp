#include "report_messages.h"

#include <fmt/format.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include "core/trace/event_stream.h"

namespace rehearse {
namespace {

/// The messages of both runs by tick; of the same tick first those of the run.
class BothStreams {
 public:
  BothStreams(const ReportedRun& actual, const ReportedRun* golden) {
    streams_[0] = std::make_unique<EventStream>(actual.trace);
    if (golden) streams_[1] = std::make_unique<EventStream>(golden->trace);
    for (std::size_t run = 0; run < streams_.size(); ++run) advance(run);
  }

  /// The next message, valid until the next call; null after the last.
  const msg::Event* next() {
    if (run_) advance(*run_);
    run_ = next_[1] && (!next_[0] || next_[1]->tick < next_[0]->tick) ? 1 : 0;
    return next_[*run_];
  }
  /// The run of the message that next() returned.
  std::size_t run() const { return *run_; }

 private:
  void advance(std::size_t run) { next_[run] = streams_[run] ? streams_[run]->next() : nullptr; }

  std::array<std::unique_ptr<EventStream>, 2> streams_;
  std::array<const msg::Event*, 2> next_{};
  std::optional<std::size_t> run_;
};

}  // namespace

MessageWriter::Extent MessageWriter::extent_of(std::int64_t tick) const {
  Extent extent;
  BothStreams streams(actual_, golden_);
  while (const msg::Event* event = streams.next()) {
    ++extent.all;
    if (event->tick < tick) ++extent.before;
  }
  return extent;
}

void MessageWriter::write(ReportJson& object, std::int64_t tick) {
  const Extent extent = extent_of(tick);
  const std::uint64_t listed = std::min(extent.all, limits_.listed);
  const std::uint64_t first = std::min(extent.before - std::min(extent.before, listed / 2), extent.all - listed);
  ReportJson& events = object["events"] = ReportJson::array();
  ReportJson blobs = ReportJson::array(), some = ReportJson::array();
  const std::uint64_t most_coded = blobs_.coded() + limits_.of_blobs;
  std::uint64_t at = 0, stored = 0;
  const auto store = [&] {
    if (some.empty()) return;
    ReportJson blob = blobs_.text(some.dump(-1, ' ', false, ReportJson::error_handler_t::replace));
    stored += some.size();
    blob["messages"] = some.size();
    blobs.push_back(std::move(blob));
    some = ReportJson::array();
  };
  BothStreams streams(actual_, golden_);
  for (; const msg::Event* event = streams.next(); ++at) {
    if (at >= first && at < first + listed)
      events.push_back({{"run", streams.run()},
                        {"tick", event->tick},
                        {"severity", event->severity},
                        {"source", event->source},
                        {"text", event->text}});
    if (listed == extent.all || blobs_.coded() >= most_coded) continue;
    some.push_back({streams.run(), event->tick, event->severity, event->source, event->text});
    if (some.size() == limits_.in_blob) store();
  }
  store();
  if (listed == extent.all) return;
  object["messages"] = {{"all", extent.all}, {"first", first}, {"blobs", std::move(blobs)}};
  if (stored < extent.all)
    omitted_.push_back(
        fmt::format("The last {} of {} messages are only in the recording.", extent.all - stored, extent.all));
}

}  // namespace rehearse
