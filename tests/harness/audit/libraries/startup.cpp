// Switches to flush-to-zero in the constructor of a static object.
#include <xmmintrin.h>

namespace {

struct Quick {
  Quick() { _mm_setcsr(_mm_getcsr() | 0x8040); }
} quick;

}  // namespace
