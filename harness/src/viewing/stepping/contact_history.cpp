#include "contact_history.h"

#include <rehearse/cdr.h>
#include <rehearse/messages.h>

#include <algorithm>

namespace rehearse {
namespace {

bool has(const std::vector<std::size_t>& ids, std::size_t id) { return std::ranges::find(ids, id) != ids.end(); }

}  // namespace

std::size_t ContactHistory::id_of(const std::string& link) {
  const auto known = std::ranges::find(links_, link);
  if (known == links_.end()) return links_.push_back(link), links_.size() - 1;
  return static_cast<std::size_t>(known - links_.begin());
}

void ContactHistory::read_until(std::uint64_t time) {
  if (!channel_ || time < read_until_) return;
  for (auto next = finder_.next(*channel_, read_until_); next && next->time <= time;) {
    for (const MessageFinder::Found& found : finder_.at(*channel_, next->time)) {
      CdrReader reader(found.data);
      msg::ContactChange change;
      if (!msg::decode(reader, change)) continue;
      const LinkIds ids{id_of(change.link), id_of(change.other)};
      pairs_[ids].push_back({found.time, change.begins});
    }
    next = finder_.next(*channel_, next->time + 1);
  }
  read_until_ = time + 1;
}

std::vector<ContactHistory::Pair> ContactHistory::at(std::uint64_t time) {
  read_until(time);
  std::vector<Pair> all;
  for (const auto& [ids, changes] : pairs_) {
    const auto after = std::upper_bound(changes.begin(), changes.end(), time,
                                        [](std::uint64_t t, const Change& change) { return t < change.time; });
    if (after == changes.begin()) continue;
    const Change& last = *std::prev(after);
    if (last.begins || last.time == time) all.push_back({ids.first, ids.second, last.begins, last.time == time});
  }
  return all;
}

bool ContactHistory::touching(const std::vector<std::size_t>& links, const std::vector<std::size_t>& others,
                              std::uint64_t time) {
  const auto pairs = at(time);
  return std::ranges::any_of(pairs, [&](const Pair& pair) {
    if (!pair.touches) return false;
    if (others.empty()) return has(links, pair.link) || has(links, pair.other);
    return (has(links, pair.link) && has(others, pair.other)) || (has(links, pair.other) && has(others, pair.link));
  });
}

}  // namespace rehearse
