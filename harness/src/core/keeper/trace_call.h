// TraceCall: a call of mcap::Writer as a message from a process to its parent. Both sides use these types.
#pragma once

#include <rehearse/cdr.h>
#include <rehearse/diagnostic.h>
#include <rehearse/mcap.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse::trace_call {

enum class Kind : std::uint8_t {
  create = 1,
  add_schema,
  add_channel,
  write,
  write_later,
  begin_pending,
  write_pending,  // like write, if the process ends before the next message on /tick
  copy_chunk,
  add_attachment,
  add_metadata,
  add_at_failure,  // metadata, if the process ends without close()
  status,
  flush,
  close,
  drop,    // the Writer is destroyed
  abandon  // the same, by an exception
};

/// The form of recordings, in whichever process they are written.
inline mcap::WriterOptions form_of_recordings() {
  mcap::WriterOptions form;
  form.verified = true;
  return form;
}

/// The beginning of each message. The numbers of write() and write_later() are in it, because these are in every tick.
struct Head {
  Kind kind{};
  std::uint8_t numbered = 0;  // 1: `number` is the sequence of the message
  std::uint16_t channel = 0;
  std::uint32_t trace = 0;  // number of the Writer
  std::uint64_t log_time = 0, publish_time = 0;
  std::uint64_t number = 0;         // the sequence; of write_later() the size by which it counts
  mcap::Compose compose = nullptr;  // valid in both processes, because one is a fork of the other
};

// The rest of a message, for the kinds whose rest is not the bytes of a message in the trace.

struct Create {
  static constexpr std::string_view type_name = "Create";
  std::string file, name;  // an absolute path, and the name in diagnostics
  REHEARSE_FIELDS(file, name)
};

struct AddSchema {
  static constexpr std::string_view type_name = "AddSchema";
  std::string name, encoding, data;
  REHEARSE_FIELDS(name, encoding, data)
};

struct StringPair {
  static constexpr std::string_view type_name = "StringPair";
  std::string key, value;
  REHEARSE_FIELDS(key, value)
};

struct AddChannel {
  static constexpr std::string_view type_name = "AddChannel";
  std::uint16_t schema = 0;
  std::string topic, encoding;
  std::vector<StringPair> metadata;
  std::int32_t group = 0;
  std::uint8_t compression = 0;
  REHEARSE_FIELDS(schema, topic, encoding, metadata, group, compression)
};

struct AddAttachment {
  static constexpr std::string_view type_name = "AddAttachment";
  std::string name, media_type;
  std::uint64_t log_time = 0, create_time = 0;
  std::vector<std::uint8_t> data;
  REHEARSE_FIELDS(name, media_type, log_time, create_time, data)
};

struct AddMetadata {
  static constexpr std::string_view type_name = "AddMetadata";
  std::string name;
  std::vector<StringPair> values;
  REHEARSE_FIELDS(name, values)
};

/// A Diagnostic without a line.
struct Finding {
  static constexpr std::string_view type_name = "Finding";
  std::string file, message, hint;
  REHEARSE_FIELDS(file, message, hint)
};

/// The answer to create, status, flush and close: nothing, or the errors.
struct Answer {
  static constexpr std::string_view type_name = "Answer";
  std::vector<Finding> errors;
  bool changed_by_others = false;
  std::uint64_t deadline = 0;  // mcap::Writer::deadline()
  REHEARSE_FIELDS(errors, changed_by_others, deadline)
};

inline std::vector<StringPair> pairs_of(const mcap::StringMap& map) {
  std::vector<StringPair> pairs;
  for (const auto& [key, value] : map) pairs.push_back({key, value});
  return pairs;
}

inline mcap::StringMap map_of(const std::vector<StringPair>& pairs) {
  mcap::StringMap map;
  for (const StringPair& pair : pairs) map.emplace(pair.key, pair.value);
  return map;
}

}  // namespace rehearse::trace_call
