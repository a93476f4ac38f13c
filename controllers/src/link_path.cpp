#include <algorithm>
#include <cnoid/LinkPath>
#include <stdexcept>
#include <utility>

namespace cnoid {

namespace {

/// The link, its parent, and so on to the root.
std::vector<LinkPtr> wayToRoot(Link* link) {
  std::vector<LinkPtr> way;
  for (; link; link = link->parent()) way.push_back(link);
  return way;
}

}  // namespace

bool LinkPath::setPath(Link* base, Link* end) {
  if (!base || !end) throw std::invalid_argument("a path between links needs two links: one of them is null");
  clear();
  std::vector<LinkPtr> up = wayToRoot(base);
  std::vector<LinkPtr> down = wayToRoot(end);
  if (up.back() != down.back()) return false;
  // The common part of both ways above the link where they meet does not belong to the path.
  LinkPtr meeting;
  while (!up.empty() && !down.empty() && up.back() == down.back()) {
    meeting = up.back();
    up.pop_back();
    down.pop_back();
  }
  numUpwardSteps_ = static_cast<int>(up.size());
  links_ = std::move(up);
  links_.push_back(meeting);
  links_.insert(links_.end(), down.rbegin(), down.rend());
  hasRootUpperLinks_ = numUpwardSteps_ > 0;
  hasRootLowerLinks_ = !hasRootUpperLinks_ && numLinks() > 1;
  return true;
}

void LinkPath::setPath(Link* end) {
  clear();
  links_ = wayToRoot(end);
  std::reverse(links_.begin(), links_.end());
  hasRootLowerLinks_ = numLinks() > 1;
}

}  // namespace cnoid
