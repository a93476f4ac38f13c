// What a file's records say of the file, taken in one by one: the same for a mapped file and for a stream. Internal.
#pragma once

#include "damage_log.h"
#include "records.h"

namespace rehearse::mcap {

struct Contents {
  std::string profile;
  std::string library;
  std::map<std::uint16_t, Schema> schemas;
  std::map<std::uint16_t, Channel> channels;
  std::optional<Statistics> statistics;

  /// Takes in a Schema or Channel record; anything else is ignored. Contradictions go to `damage`.
  void learn(const Record& record, DamageLog& damage);
  void learn_header(const Record& record, DamageLog& damage);
  const Schema* schema_of(const Channel& channel) const;
  /// The message of a record; its channel null (and damage logged) if it can't be had.
  Message read_message(const Record& record, DamageLog& damage) const;

 private:
  void learn_schema(const Record& record, DamageLog& damage);
  void learn_channel(const Record& record, DamageLog& damage);
};

/// The attachment of a record, its data where the record's is; nullopt (and damage logged) if it isn't whole.
std::optional<Attachment> read_attachment(const Record& record, bool check_crc, DamageLog& damage);
/// The same of metadata.
std::optional<Metadata> read_metadata(const Record& record, DamageLog& damage);

}  // namespace rehearse::mcap
