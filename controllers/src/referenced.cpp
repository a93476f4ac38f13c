#include <cnoid/ClonableReferenced>
#include <cnoid/Referenced>

namespace cnoid {

Referenced::~Referenced() {
  if (life_) *life_ = false;
}

ClonableReferenced::~ClonableReferenced() = default;

}  // namespace cnoid
