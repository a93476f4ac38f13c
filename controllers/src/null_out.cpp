#include <cnoid/NullOut>

namespace cnoid {

std::ostream& nullout() {
  static std::ostream stream(nullptr);  // without a buffer every output fails silently
  return stream;
}

}  // namespace cnoid
