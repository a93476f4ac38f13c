#include "merge.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <tuple>

#include "base/text.h"
#include "chunks.h"
#include "draft.h"
#include "reader_impl.h"
#include "whole_input.h"

namespace rehearse::mcap {

namespace {

constexpr std::uint64_t progress_step = 1 << 16;  // [messages]
constexpr int groups_of_a_source = 0x20000;       // more than the groups of any source

/// A source that is being read.
struct OpenSource {
  std::string prefix;
  std::unique_ptr<Reader> reader;
  std::unique_ptr<OrderedMessages> messages;
  const Message* next = nullptr;  // null after the last message

  std::vector<std::uint16_t> ids = std::vector<std::uint16_t>(0x10000);  // ids in the target by ids in the source
};

Result<std::unique_ptr<OpenSource>> open_source(const MergeSource& source) {
  auto reader = REHEARSE_TRY(Reader::open(source.file));
  if (!reader->damage().empty()) return with_recover_hint(reader->damage());
  auto open = std::make_unique<OpenSource>();
  open->prefix = source.prefix;
  open->reader = std::move(reader);
  open->messages = std::make_unique<OrderedMessages>(*open->reader);
  return open;
}

class Merger {
 public:
  Merger(const std::vector<std::unique_ptr<OpenSource>>& sources, Writer& writer, const MergeOptions& options)
      : sources_(sources), writer_(writer), options_(options) {}

  Result<Merged> run();

 private:
  using Key = std::tuple<std::string, std::string, std::uint16_t, StringMap>;  // topic, encoding, schema, metadata

  void define(OpenSource& source, int index);
  Result<void> write_extras();
  Result<void> write_messages();

  const std::vector<std::unique_ptr<OpenSource>>& sources_;
  Writer& writer_;
  const MergeOptions& options_;
  std::map<Key, std::uint16_t> channels_;
  std::map<std::string, int> definitions_;  // by topic: number of its channels
  Merged merged_;
};

void Merger::define(OpenSource& source, int index) {
  const ChannelGroups groups = groups_of(source.reader->impl().file_, source.reader->impl().bytes_);
  if (std::string remark = private_remark(groups, source.reader->name()); !remark.empty())
    merged_.remarks.push_back(std::move(remark));
  std::set<std::uint16_t> own;  // channels that other channels of this source must not share
  for (const auto& [id, channel] : source.reader->channels()) {
    const std::uint16_t schema_id = copy(source.reader->schema_of(channel), writer_);
    const std::string topic = source.prefix + channel.topic;
    const Key key{topic, channel.message_encoding, schema_id, channel.metadata};
    const auto known = options_.keep_apart ? channels_.end() : channels_.find(key);
    if (known != channels_.end() && own.insert(known->second).second) {
      source.ids[id] = known->second;
      continue;
    }
    ChunkGroup group = groups.of(id);
    group.id += index * groups_of_a_source;
    source.ids[id] = writer_.add_channel(schema_id, topic, channel.message_encoding, channel.metadata, group);
    own.insert(source.ids[id]);
    channels_.try_emplace(key, source.ids[id]);
    ++merged_.channels;
    if (++definitions_[topic] == 2 && !options_.keep_apart)
      merged_.remarks.push_back(fmt::format("{} has several definitions: it has a channel for each", in_quotes(topic)));
  }
}

/// Writes attachments and metadata, source by source.
Result<void> Merger::write_extras() {
  std::map<std::string, int> names;
  StringMap note;
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const Reader& reader = *sources_[i]->reader;
    note[fmt::format("source.{}", i)] = printable(std::filesystem::path(reader.name()).filename().string(), 200);
    for (const Attachment& attachment : reader.attachments()) {
      ++merged_.attachments;
      if (++names["the attachment " + in_quotes(attachment.name)] == 2)
        merged_.remarks.push_back(fmt::format("the attachment {} occurs more than once", in_quotes(attachment.name)));
      REHEARSE_TRY(copy(attachment, writer_));
    }
    for (const Metadata& metadata : reader.metadata()) {
      ++merged_.metadata;
      if (++names["the metadata record " + in_quotes(metadata.name)] == 2)
        merged_.remarks.push_back(
            fmt::format("the metadata record {} occurs more than once", in_quotes(metadata.name)));
      REHEARSE_TRY(writer_.add_metadata(metadata.name, metadata.values));
    }
  }
  return writer_.add_metadata("rehearse.merge", note);
}

Result<void> Merger::write_messages() {
  std::uint64_t all = 0;
  for (const auto& source : sources_)
    if (source->reader->statistics()) all += source->reader->statistics()->message_count;
  for (const auto& source : sources_) source->next = source->messages->next();
  while (true) {
    OpenSource* first = nullptr;  // There are few files: a loop over them is faster than a heap.
    for (const auto& source : sources_)
      if (source->next != nullptr && (first == nullptr || source->next->log_time < first->next->log_time))
        first = source.get();
    if (first == nullptr) return {};
    const Message& message = *first->next;
    if (auto done = writer_.write(first->ids[message.channel->id], message.log_time, message.publish_time, message.data,
                                  message.sequence);
        !done)
      return done;
    first->next = first->messages->next();
    if (++merged_.messages % progress_step == 0 && options_.progress)
      options_.progress(merged_.messages, std::max(all, merged_.messages));
  }
}

Result<Merged> Merger::run() {
  for (std::size_t i = 0; i < sources_.size(); ++i) define(*sources_[i], static_cast<int>(i));
  REHEARSE_TRY(write_extras());
  REHEARSE_TRY(write_messages());
  for (const auto& source : sources_)
    if (const auto verdict = source->messages->verdict(); !verdict) return with_recover_hint(verdict.errors());
  REHEARSE_TRY(writer_.close());
  return merged_;
}

}  // namespace

Result<Merged> merge(const std::vector<MergeSource>& sources, const std::filesystem::path& target,
                     const MergeOptions& options) {
  REHEARSE_ASSERT(!sources.empty() && sources.size() < 0x4000,
                  "there is at least one source, and the ids of groups suffice for all");
  std::vector<std::unique_ptr<OpenSource>> open;
  std::vector<std::filesystem::path> files;
  for (const MergeSource& source : sources) {
    auto opened = REHEARSE_TRY(open_source(source));
    open.push_back(std::move(opened));
    files.push_back(source.file);
  }
  auto draft = REHEARSE_TRY(Draft::begin(target, files));
  WriterOptions form;
  form.profile = open.front()->reader->profile();
  for (const auto& source : open)
    if (source->reader->profile() != form.profile) form.profile.clear();
  auto writer = REHEARSE_TRY(draft.open_writer(form));
  auto merged = Merger(open, *writer, options).run();
  if (!merged) return merged;
  merged->bytes = draft.size();
  REHEARSE_TRY(draft.finish());
  return merged;
}

}  // namespace rehearse::mcap
