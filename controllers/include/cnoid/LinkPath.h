// LinkPath: the links between two links of a body, both included. It may climb towards the root before it descends.
#pragma once

#include "LinkTraverse.h"

namespace cnoid {

class CNOID_GENERAL_EXPORT LinkPath : public LinkTraverse {
 public:
  LinkPath() = default;
  LinkPath(Link* base, Link* end) { setPath(base, end); }
  /// Sets the path from the root link to `end`.
  explicit LinkPath(Link* end) { setPath(end); }

  /// False, and an empty path, if the links belong to different trees. Throws std::invalid_argument if one is null.
  bool setPath(Link* base, Link* end);
  void setPath(Link* end);

  /// Null if the path is empty.
  Link* baseLink() const { return rootLink(); }
  Link* endLink() const { return empty() ? nullptr : links_.back().get(); }

 private:
  using LinkTraverse::find;  // a path has one end
};

}  // namespace cnoid
