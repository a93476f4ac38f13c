// A file in a form that other writers produce: without some of its optional parts. Composed from a file of the Writer,
// record by record; mcap/conformance_test.cpp compares its files with those of the format's own suite.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <set>

#include "composer.h"
#include "core/mcap/chunks.h"

namespace rehearse::test {

/// The optional parts of a file. The format demands none of them.
struct FileForm {
  bool chunks = true;                  // false: messages are not in chunks
  bool definitions_in_chunks = false;  // schemas and channels before their first message in each chunk, nowhere else
  bool message_indexes = true;
  bool crcs = true;
  bool summary = true;  // false: none of the parts below, except the CRC
  bool repeated_schemas = true;
  bool repeated_channels = true;
  bool statistics = true;
  bool chunk_indexes = true;
  bool attachment_indexes = true;
  bool metadata_indexes = true;
  bool summary_offsets = true;
};

/// Composes the file; `whole` is a file of the Writer.
class Recomposition {
 public:
  Recomposition(mcap::Bytes whole, const FileForm& form) : form_(form) {
    out_.magic();
    mcap::RecordWalker walker(whole, mcap::magic.size());
    mcap::Record record;
    while (walker.next(record) && record.opcode != mcap::op::data_end) put(record);
    out_.record(mcap::op::data_end, Composer().put(form.crcs ? mcap::crc32(out_.bytes) : 0u));
    while (walker.next(record))
      if (record.opcode == mcap::op::statistics) put_summary(record);
  }
  const Buffer& bytes() const { return out_.bytes; }

 private:
  using Entries = std::map<std::uint16_t, Composer>;  // time and offset of each message, by channel

  void put(const mcap::Record& record) {
    const std::uint64_t start = out_.bytes.size();
    switch (record.opcode) {
      case mcap::op::schema: return put_definition(record, schemas_[id_of(record)]);
      case mcap::op::channel: return put_definition(record, channels_[id_of(record)]);
      case mcap::op::chunk: return put_chunk(record);
      case mcap::op::message_index: return;
      case mcap::op::attachment: {
        copy(record);
        if (!form_.crcs) std::fill(out_.bytes.end() - 4, out_.bytes.end(), std::byte{0});
        const mcap::Attachment a = mcap::parse_attachment(record.body)->attachment;
        attachment_indexes_.record(mcap::op::attachment_index, Composer()
                                                                   .put(start)
                                                                   .put(out_.bytes.size() - start)
                                                                   .put(a.log_time)
                                                                   .put(a.create_time)
                                                                   .put(std::uint64_t{a.data.size()})
                                                                   .text(a.name)
                                                                   .text(a.media_type));
        return;
      }
      case mcap::op::metadata:
        copy(record);
        metadata_indexes_.record(
            mcap::op::metadata_index,
            Composer().put(start).put(out_.bytes.size() - start).text(mcap::parse_metadata(record.body)->name));
        return;
      default: copy(record);
    }
  }
  static std::uint16_t id_of(const mcap::Record& record) { return mcap::ByteReader(record.body).get<std::uint16_t>(); }
  void copy(const mcap::Record& record) { out_.raw(mcap::bytes_of(record)); }
  void put_definition(const mcap::Record& record, mcap::Bytes& definition) {
    definition = mcap::bytes_of(record);
    if (!form_.chunks || !form_.definitions_in_chunks) copy(record);
  }

  /// The records of a chunk with the definitions before the first message of each channel.
  Composer with_definitions(mcap::Bytes records) {
    Composer all;
    std::set<std::uint16_t> defined;
    mcap::RecordWalker inside(records);
    for (mcap::Record record; inside.next(record);) {
      const std::uint16_t id = id_of(record);
      if (defined.insert(id).second) {
        const mcap::Bytes channel = channels_.at(id);
        const auto schema = mcap::parse_channel(channel.subspan(mcap::record_head))->schema_id;
        if (schema != 0) all.raw(schemas_.at(schema));
        all.raw(channel);
      }
      all.raw(mcap::bytes_of(record));
    }
    return all;
  }

  void put_chunk(const mcap::Record& record) {
    const auto opened = opener_.open(record, buffer_);
    if (!form_.chunks) {
      out_.raw(opened.records);
      return;
    }
    const std::uint64_t start = out_.bytes.size();
    const mcap::ChunkHead& head = opened.head;
    Composer records = Composer().raw(opened.records);
    mcap::Bytes stored = head.records;
    std::string_view compression = head.compression;
    if (form_.definitions_in_chunks) {
      records = with_definitions(opened.records);
      stored = records.bytes;
      compression = "";
    }
    const std::uint32_t crc = form_.crcs ? mcap::crc32(records.bytes) : 0u;
    out_.chunk(head.start_time, head.end_time, Composer().raw(stored), compression, records.bytes.size(), crc);
    const std::uint64_t length = out_.bytes.size() - start;
    const Composer places = form_.message_indexes ? put_message_indexes(records.bytes) : Composer();
    chunk_indexes_.record(mcap::op::chunk_index, Composer()
                                                     .put(head.start_time)
                                                     .put(head.end_time)
                                                     .put(start)
                                                     .put(length)
                                                     .put(static_cast<std::uint32_t>(places.bytes.size()))
                                                     .raw(places.bytes)
                                                     .put(out_.bytes.size() - start - length)
                                                     .text(compression)
                                                     .put(std::uint64_t{stored.size()})
                                                     .put(std::uint64_t{records.bytes.size()}));
  }
  /// Returns channel and place of each index.
  Composer put_message_indexes(mcap::Bytes records) {
    Entries entries;
    mcap::RecordWalker inside(records);
    for (mcap::Record record; inside.next(record);) {
      if (record.opcode != mcap::op::message) continue;
      const auto message = *mcap::parse_message_head(record.body);
      entries[message.channel].put(message.log_time).put(record.offset);
    }
    Composer places;
    for (const auto& [channel, all] : entries) {
      places.put(channel).put(std::uint64_t{out_.bytes.size()});
      out_.record(mcap::op::message_index,
                  Composer().put(channel).put(static_cast<std::uint32_t>(all.bytes.size())).raw(all.bytes));
    }
    return places;
  }

  void put_summary(const mcap::Record& statistics) {
    const std::uint64_t start = out_.bytes.size();
    Composer offsets, schemas, channels, counts;
    for (const auto& [id, schema] : schemas_) schemas.raw(schema);
    for (const auto& [id, channel] : channels_) channels.raw(channel);
    counts.raw(mcap::bytes_of(statistics));
    if (!form_.chunks) std::fill_n(counts.bytes.begin() + mcap::record_head + 22, 4, std::byte{0});  // of the chunks
    const auto put_group = [&](bool wanted, std::uint8_t opcode, const Composer& records) {
      if (!wanted || !form_.summary || records.bytes.empty()) return;
      offsets.record(
          mcap::op::summary_offset,
          Composer().put(opcode).put(std::uint64_t{out_.bytes.size()}).put(std::uint64_t{records.bytes.size()}));
      out_.raw(records.bytes);
    };
    put_group(form_.repeated_schemas, mcap::op::schema, schemas);
    put_group(form_.repeated_channels, mcap::op::channel, channels);
    put_group(form_.statistics, mcap::op::statistics, counts);
    put_group(form_.chunk_indexes, mcap::op::chunk_index, chunk_indexes_);
    put_group(form_.attachment_indexes, mcap::op::attachment_index, attachment_indexes_);
    put_group(form_.metadata_indexes, mcap::op::metadata_index, metadata_indexes_);
    const std::uint64_t offsets_at = out_.bytes.size();
    const bool has_offsets = form_.summary_offsets && !offsets.bytes.empty();
    if (has_offsets) out_.raw(offsets.bytes);
    const bool empty = offsets_at == start;
    Composer footer;
    footer.record(
        mcap::op::footer,
        Composer().put(empty ? std::uint64_t{0} : start).put(has_offsets ? offsets_at : std::uint64_t{0}).put(0u));
    footer.bytes.resize(footer.bytes.size() - 4);
    out_.raw(footer.bytes);
    out_.put(form_.crcs ? mcap::crc32(mcap::Bytes(out_.bytes).subspan(start)) : 0u).magic();
  }

  const FileForm form_;
  Composer out_, chunk_indexes_, attachment_indexes_, metadata_indexes_;
  std::map<std::uint16_t, mcap::Bytes> schemas_, channels_;  // whole records
  mcap::ChunkOpener opener_{{}};
  mcap::RawBuffer buffer_;
};

inline Buffer in_form(mcap::Bytes whole, const FileForm& form) { return Recomposition(whole, form).bytes(); }

}  // namespace rehearse::test
