// The pairs of links of one body that touch each other.

#include <algorithm>
#include <array>
#include <set>

#include "shape_contacts.h"
#include "simulated_body.h"

namespace rehearse {

namespace {

using Pair = std::pair<int, int>;

/// The pairs of rigid groups that a joint connects, the smaller number first.
std::set<Pair> joined_groups(const std::vector<Link>& links, const std::vector<int>& groups) {
  std::set<Pair> joined;
  for (std::size_t i = 0; i < links.size(); ++i)
    if (links[i].parent >= 0 && links[i].joint.type != JointType::free)
      joined.insert(std::minmax(groups[i], groups[links[i].parent]));
  return joined;
}

/// By link: the nearest link above it, or itself, that no joint connects to its parent.
std::vector<int> free_links(const std::vector<Link>& links) {
  std::vector<int> roots;
  for (std::size_t i = 0; i < links.size(); ++i)
    roots.push_back(links[i].parent < 0 || links[i].joint.type == JointType::free ? static_cast<int>(i)
                                                                                  : roots[links[i].parent]);
  return roots;
}

}  // namespace

void SimulatedBody::pair_own_shapes() {
  if (!description_.touches) return;
  const std::vector<Link>& links = model().links;
  const std::set<Pair> joined = joined_groups(links, groups_);
  const auto may_touch = [&](int a, int b) {
    const bool wanted = description_.self_collision || (links[a].collides_with_own && links[b].collides_with_own);
    const std::array<int, 2> pair{std::min(a, b), std::max(a, b)};
    if (std::binary_search(model().apart.begin(), model().apart.end(), pair)) return false;
    return wanted && !move_together(a, b) && !joined.count(std::minmax(groups_[a], groups_[b]));
  };
  const std::vector<int> roots = free_links(links);  // bodies of their own may lie on each other from the start
  std::set<Pair> overlapping;                        // links
  std::vector<std::pair<std::size_t, std::size_t>> wanted;
  std::vector<dContactGeom> one(1);
  for (std::size_t a = 0; a < shapes_.size(); ++a) {
    for (std::size_t b = a + 1; b < shapes_.size(); ++b) {
      const int link = shapes_[a].link, other = shapes_[b].link;
      if (!may_touch(link, other)) continue;
      wanted.emplace_back(a, b);
      if (roots[link] == roots[other] && collide_shapes(shapes_[a], shapes_[b], one) > 0)
        overlapping.emplace(link, other);
    }
  }
  for (const auto& [a, b] : wanted)
    if (!overlapping.count({shapes_[a].link, shapes_[b].link})) own_pairs_.emplace_back(a, b);
  if (overlapping.empty()) return;
  std::string names;
  for (const auto& [link, other] : overlapping)
    names += (names.empty() ? "'" : ", '") + links[link].name + "' and '" + links[other].name + "'";
  remarks_.push_back(warning("body '" + description_.name + "': these links overlap when all joints are at zero, so " +
                             "they don't touch each other: " + names));
}

}  // namespace rehearse
