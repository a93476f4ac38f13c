#include "remaining_links.h"

#include <algorithm>

#include "link_motion.h"

namespace cnoid {

void calcRemainingForwardKinematics(Link& end, const std::vector<const LinkPath*>& paths) {
  const LinkTraverse all(&end, true, true);
  for (int i = 1; i < all.numLinks(); ++i) {
    Link* link = all[i];
    const auto contains = [link](const LinkPath* path) {
      return std::find(path->begin(), path->end(), LinkPtr(link)) != path->end();
    };
    if (std::any_of(paths.begin(), paths.end(), contains)) continue;
    all.isDownward(i - 1) ? setPose(*link, *link->parent()) : setPoseOfParent(*link, *all[i - 1]);
  }
}

}  // namespace cnoid
