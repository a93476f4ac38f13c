// ContactHistory: the links that touch at a time, computed from the recorded changes. Changes are read as far as
// needed, and kept: 16 bytes per change. Internal.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "message_finder.h"

namespace rehearse {

class ContactHistory {
 public:
  using LinkIds = std::pair<std::size_t, std::size_t>;
  struct Pair {
    std::size_t link = 0, other = 0;
    bool touches = false;
    bool changed = false;  // the contact changed at exactly this time
  };

  /// `links`: BODY/LINK of all links. `channel`: the channel of changes; none: the recording has none.
  ContactHistory(MessageFinder& finder, std::optional<std::uint16_t> channel, std::vector<std::string> links)
      : finder_(finder), channel_(channel), links_(std::move(links)) {}

  bool is_recorded() const { return channel_.has_value(); }
  const std::vector<std::string>& links() const { return links_; }
  /// The pairs in contact, and the pairs whose contact changed at that time.
  std::vector<Pair> at(std::uint64_t time);
  bool touching(const std::vector<std::size_t>& links, const std::vector<std::size_t>& others, std::uint64_t time);

 private:
  struct Change {
    std::uint64_t time = 0;
    bool begins = false;
  };
  void read_until(std::uint64_t time);
  std::size_t id_of(const std::string& link);

  MessageFinder& finder_;
  std::optional<std::uint16_t> channel_;
  std::vector<std::string> links_;
  std::map<LinkIds, std::vector<Change>> pairs_;
  std::uint64_t read_until_ = 0;  // all changes before this time were read [ns]
};

}  // namespace rehearse
