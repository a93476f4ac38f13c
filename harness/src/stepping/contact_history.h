// ContactHistory: which links touch at a time, out of the changes that a recording has. Read as far as is asked for,
// and kept: 16 bytes a change. Internal.
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
    bool changed = false;  // at that very time
  };

  /// `links`: BODY/LINK of all links. `channel`: of the changes; none: the recording has none.
  ContactHistory(MessageFinder& finder, std::optional<std::uint16_t> channel, std::vector<std::string> links)
      : finder_(finder), channel_(channel), links_(std::move(links)) {}

  bool is_recorded() const { return channel_.has_value(); }
  const std::vector<std::string>& links() const { return links_; }
  /// Those that touch, and those that changed at that time.
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
  std::uint64_t read_until_ = 0;  // all before this time is read [ns]
};

}  // namespace rehearse
