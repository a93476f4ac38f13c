#include "filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/glob.h"
#include "base/text.h"
#include "core/mcap/chunks.h"
#include "core/mcap/draft.h"
#include "core/mcap/reader_impl.h"
#include "core/mcap/whole_input.h"
#include "run_facts.h"

namespace rehearse::mcap {

namespace {

std::string join(const std::vector<std::string>& words) { return fmt::format("{}", fmt::join(words, " ")); }

/// One call of filter().
class Filter {
 public:
  Filter(const FileView& file, Reader& reader, Writer& writer, Selector& selector, const ChannelGroups& groups,
         const FilterOptions& options)
      : passed_(file, file.bytes(), options.progress),
        reader_(reader),
        writer_(writer),
        selector_(selector),
        groups_(groups),
        options_(options) {}

  Result<Filtered> run();

 private:
  bool chosen(const Channel& channel) const;
  bool is_taken(const Message& message) const;
  void define();
  Result<void> write_extras_before(std::uint64_t offset);
  Result<void> write_note();
  Result<void> write(const Message& message);

  PassedBytes passed_;
  Reader& reader_;
  Writer& writer_;
  Selector& selector_;
  const ChannelGroups& groups_;
  const FilterOptions& options_;
  // Ids in the target.
  std::vector<std::optional<std::uint16_t>> ids_ = std::vector<std::optional<std::uint16_t>>(0x10000);
  std::vector<bool> reduced_ = std::vector<bool>(0x10000);  // by ids in the source: only samples are kept
  std::size_t next_attachment_ = 0, next_metadata_ = 0;
  Filtered filtered_;
};

bool Filter::chosen(const Channel& channel) const {
  return selector_.takes_topic(channel.topic) &&
         std::ranges::none_of(options_.exclude,
                              [&](const std::string& pattern) { return matches(pattern, channel.topic); });
}

bool Filter::is_taken(const Message& message) const {
  if (!ids_[message.channel->id] || !selector_.takes_time(message.log_time)) return false;
  return !reduced_[message.channel->id] || options_.samples->is_sample(message.log_time);
}

void Filter::define() {
  for (const auto& [id, channel] : reader_.channels()) {
    if (!chosen(channel)) continue;
    const std::uint16_t schema = copy(reader_.schema_of(channel), writer_);
    ids_[id] = writer_.add_channel(schema, channel.topic, channel.message_encoding, channel.metadata, groups_.of(id));
    reduced_[id] = options_.samples && options_.samples->reduces(channel.topic);
    ++filtered_.channels;
  }
}

/// Writes attachments and metadata before that byte of the source.
Result<void> Filter::write_extras_before(std::uint64_t offset) {
  const auto& attachments = reader_.attachments();
  for (; next_attachment_ < attachments.size() && attachments[next_attachment_].offset < offset; ++next_attachment_) {
    const std::string& name = attachments[next_attachment_].name;
    if (std::ranges::none_of(options_.attachments, [&](const std::string& pattern) { return matches(pattern, name); }))
      continue;
    ++filtered_.attachments;
    REHEARSE_TRY(copy(attachments[next_attachment_], writer_));
  }
  const auto& metadata = reader_.metadata();
  for (; next_metadata_ < metadata.size() && metadata[next_metadata_].offset < offset; ++next_metadata_) {
    if (!options_.metadata) continue;
    ++filtered_.metadata;
    REHEARSE_TRY(writer_.add_metadata(metadata[next_metadata_].name, metadata[next_metadata_].values));
  }
  return {};
}

/// Writes the rate of the state, and the record that names the source.
Result<void> Filter::write_note() {
  if (options_.samples) REHEARSE_TRY(writer_.add_metadata(records::state_rate, options_.samples->metadata()));
  if (!options_.cuts() || !options_.metadata) return {};
  StringMap note{{"source", printable(std::filesystem::path(reader_.name()).filename().string(), 200)},
                 {"source_messages", std::to_string(filtered_.messages + filtered_.left_out)}};
  if (!options_.selection.topics.empty()) note["topics"] = join(options_.selection.topics);
  if (!options_.exclude.empty()) note["exclude"] = join(options_.exclude);
  if (!options_.selection.takes_all_times()) {
    note["from_ns"] = std::to_string(selector_.begin());
    if (selector_.end()) note["until_ns"] = std::to_string(*selector_.end());
  }
  if (options_.attachments.empty())
    note["attachments"] = "left out";
  else if (options_.attachments != FilterOptions().attachments)
    note["attachments"] = join(options_.attachments);
  return writer_.add_metadata("rehearse.filter", note);
}

Result<void> Filter::write(const Message& message) {
  filtered_.first_time = filtered_.messages == 0 ? message.log_time : std::min(filtered_.first_time, message.log_time);
  filtered_.last_time = std::max(filtered_.last_time, message.log_time);
  ++filtered_.messages;
  return writer_.write(*ids_[message.channel->id], message.log_time, message.publish_time, message.data,
                       message.sequence);
}

Result<Filtered> Filter::run() {
  define();
  Result<void> written;
  const auto read = reader_.for_each_message([&](const Message& message) {
    const std::uint64_t offset = message.location.record;
    passed_.pass(offset);
    if (!is_taken(message)) return ++filtered_.left_out, true;
    written = write_extras_before(offset);
    if (written) written = write(message);
    return written.ok();
  });
  if (!written) return written.errors();
  if (!read) return with_recover_hint(read.errors());
  if (filtered_.messages == 0)
    if (const auto refused = selector_.refusal_of_empty(reader_)) return *refused;
  REHEARSE_TRY(write_extras_before(std::numeric_limits<std::uint64_t>::max()));
  REHEARSE_TRY(write_note());
  REHEARSE_TRY(writer_.close());
  return filtered_;
}

WriterOptions form_of(const Reader& reader, const FilterOptions& options) {
  WriterOptions form;
  form.profile = reader.profile();
  form.compression = options.compression;
  if (options.level) form.zstd_level = form.lz4_level = *options.level;
  if (options.chunk_size) form.chunk_size = *options.chunk_size;
  return form;
}

/// Fails for a glob, other than the default, that no attachment's name matches.
Result<void> check_attachments(const Reader& reader, const FilterOptions& options) {
  if (options.attachments == FilterOptions().attachments) return {};
  std::vector<std::string> names;
  for (const Attachment& attachment : reader.attachments()) names.push_back(attachment.name);
  for (const std::string& pattern : options.attachments) {
    if (std::ranges::any_of(names, [&](const std::string& name) { return matches(pattern, name); })) continue;
    return error_in(reader.name(), fmt::format("no attachment matches '{}'", pattern),
                    names.empty() ? "it has no attachments" : "it has " + printable(join(names), 200));
  }
  return {};
}

}  // namespace

Result<Filtered> filter(const std::filesystem::path& source, const std::filesystem::path& target,
                        const FilterOptions& options) {
  const auto reader = REHEARSE_TRY(Reader::open(source));
  const FileView& view = reader->impl().file_;
  if (view.converted() && !view.converted()->damage.empty()) return view.converted()->damage;
  if (!reader->damage().empty()) return with_recover_hint(reader->damage());
  auto selector = REHEARSE_TRY(Selector::of(options.selection, *reader));
  REHEARSE_TRY(check_attachments(*reader, options));
  auto draft = REHEARSE_TRY(Draft::begin(target, std::span(&source, 1)));
  const ChannelGroups groups = groups_of(view, view.bytes());
  auto writer = REHEARSE_TRY(draft.open_writer(form_of(*reader, options)));
  auto filtered = Filter(view, *reader, *writer, selector, groups, options).run();
  if (!filtered) return filtered;
  filtered->bytes = draft.size();
  if (std::string remark = private_remark(groups, reader->name()); !remark.empty())
    filtered->remarks.push_back(std::move(remark));
  REHEARSE_TRY(draft.finish());
  return filtered;
}

}  // namespace rehearse::mcap
