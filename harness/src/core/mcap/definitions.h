// Definitions: the schemas and channels of a file that is being written, and their ids.
//
// Ids depend on the order of the calls alone. So a process that sends its calls to another, which writes the file,
// knows them without asking.
#pragma once

#include <rehearse/mcap.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse::mcap {

class Definitions {
 public:
  static constexpr std::size_t most_schemas = 0xffff;  // the id 0 means none
  static constexpr std::size_t most_channels = 0x10000;

  /// The id of the schema; 0: it is one too many. An equal schema has the same id. `added`: it is a new one.
  std::uint16_t add_schema(std::string_view name, std::string_view encoding, std::string_view data, bool& added) {
    added = false;
    const auto [first, last] = by_name_.equal_range(name);
    for (auto place = first; place != last; ++place) {
      const Schema& schema = schemas_[place->second - 1u];
      if (schema.encoding == encoding && schema.data == data) return schema.id;
    }
    if (schemas_.size() == most_schemas) return 0;
    added = true;
    const auto id = static_cast<std::uint16_t>(schemas_.size() + 1);
    schemas_.push_back({id, std::string(name), std::string(encoding), std::string(data)});
    by_name_.emplace(name, id);
    return id;
  }

  bool has_room_for_a_channel() const { return channels_.size() < most_channels; }
  /// The last id is 0.
  std::uint16_t add_channel(std::uint16_t schema, std::string_view topic, std::string_view message_encoding,
                            StringMap metadata) {
    const auto id = static_cast<std::uint16_t>(channels_.size() + 1);
    channels_.push_back({id, schema, std::string(topic), std::string(message_encoding), std::move(metadata)});
    return id;
  }

  static std::size_t index_of(std::uint16_t channel) { return static_cast<std::uint16_t>(channel - 1); }
  bool has_channel(std::uint16_t id) const { return index_of(id) < channels_.size(); }
  const Channel& channel(std::uint16_t id) const { return channels_[index_of(id)]; }
  const Schema& schema(std::uint16_t id) const { return schemas_[id - 1u]; }
  const std::vector<Schema>& schemas() const { return schemas_; }
  const std::vector<Channel>& channels() const { return channels_; }  // at index_of(id)

 private:
  std::vector<Schema> schemas_;
  std::multimap<std::string, std::uint16_t, std::less<>> by_name_;
  std::vector<Channel> channels_;
};

}  // namespace rehearse::mcap
