#include "export_source.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/kinds/channel_name.h"
#include "core/trace/run_facts.h"

namespace rehearse {

Result<ExportSource> ExportSource::open(const std::filesystem::path& trace, const ExportOptions& options) {
  auto reader = REHEARSE_TRY(mcap::Reader::open(trace));
  auto selector = REHEARSE_TRY(mcap::Selector::of(options.selection, *reader));
  return ExportSource(std::move(reader), std::move(selector), options);
}

ExportSource::ExportSource(std::unique_ptr<mcap::Reader> reader, mcap::Selector selector, const ExportOptions& options)
    : reader_(std::move(reader)), selector_(std::move(selector)), progress_(options.progress) {
  if (reader_->statistics()) all_ = static_cast<std::int64_t>(reader_->statistics()->message_count);
}

std::vector<const mcap::Channel*> ExportSource::channels() const {
  std::vector<const mcap::Channel*> chosen;
  for (const auto& [id, channel] : reader_->channels())
    if (selector_.takes_topic(channel.topic)) chosen.push_back(&channel);
  return chosen;
}

bool ExportSource::has_ticks() const {
  return std::ranges::any_of(reader_->channels(),
                             [](const auto& channel) { return channel.second.topic == run_topics::tick; });
}

Result<void> ExportSource::pass(const std::function<Result<void>(const mcap::Message&)>& callback) {
  std::vector<std::uint16_t> ids;
  for (const mcap::Channel* channel : channels()) ids.push_back(channel->id);
  Result<void> outcome;
  const auto read = reader_->for_each_message_in_order(
      [&](const mcap::Message& message) {
        if (progress_) progress_(++done_, passes_ * all_);
        if (selector_.takes(message)) outcome = callback(message);
        return outcome.ok();
      },
      ids);
  if (!read && !has_passed_) damage_.insert(damage_.end(), read.errors().begin(), read.errors().end());
  has_passed_ = true;
  return outcome;
}

void ExportSource::note(const mcap::Channel& channel, std::string message) {
  constexpr std::size_t limit = 50;
  if (damage_.size() < limit)
    damage_.push_back(error_in(reader_->name(), fmt::format("topic {}: {}", channel.topic, message)));
}

}  // namespace rehearse
