// Which links of a body touch each other.

#include <set>

#include "shape_contacts.h"
#include "simulated_body.h"

namespace rehearse {

/// Both say so, or the whole body does, and no joint holds one to the other's rigid group.
bool SimulatedBody::may_touch_own(int link, int other) const {
  const std::vector<Link>& links = model().links;
  if (!description_.self_collision && !(links[link].collides_with_own && links[other].collides_with_own)) return false;
  if (move_together(link, other)) return false;
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (links[i].parent < 0 || move_together(static_cast<int>(i), links[i].parent)) continue;
    const int child = groups_[i], parent = groups_[links[i].parent];
    if ((child == groups_[link] && parent == groups_[other]) || (child == groups_[other] && parent == groups_[link]))
      return false;
  }
  return true;
}

void SimulatedBody::pair_own_shapes() {
  std::set<std::pair<int, int>> overlapping;  // links
  std::vector<std::pair<std::size_t, std::size_t>> wanted;
  std::vector<dContactGeom> one(1);
  for (std::size_t a = 0; a < shapes_.size(); ++a) {
    for (std::size_t b = a + 1; b < shapes_.size(); ++b) {
      const int link = shapes_[a].link, other = shapes_[b].link;
      if (!may_touch_own(link, other)) continue;
      wanted.emplace_back(a, b);
      if (collide_shapes(shapes_[a], shapes_[b], one) > 0) overlapping.emplace(link, other);
    }
  }
  for (const auto& [a, b] : wanted)
    if (!overlapping.count({shapes_[a].link, shapes_[b].link})) own_pairs_.emplace_back(a, b);
  if (overlapping.empty()) return;
  std::string names;
  for (const auto& [link, other] : overlapping)
    names += (names.empty() ? "'" : ", '") + model().links[link].name + "' and '" + model().links[other].name + "'";
  Diagnostic remark = error("body '" + description_.name + "': these links overlap when all joints are at zero, so " +
                            "they don't touch each other: " + names);
  remark.severity = Severity::warning;
  remarks_.push_back(std::move(remark));
}

}  // namespace rehearse
