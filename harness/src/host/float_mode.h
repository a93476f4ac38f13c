// The floating-point mode of a thread: what the processor does with rounding, denormal numbers and invalid operations.
//
// Every thread has its own, and a new thread starts with that of its parent. A library linked with -ffast-math changes
// that of the thread that loads it. All of a run is computed in the standard mode, that of IEEE 754.
#pragma once

#include <rehearse/diagnostic.h>

#include <string>

namespace rehearse {

struct FloatMode {
  unsigned int sse = 0x1f80;    // MXCSR without its sticky exception flags
  unsigned short x87 = 0x037f;  // the control word of the x87, which computes long double
};

/// Of this thread.
FloatMode float_mode();
void set_float_mode(const FloatMode& mode);
bool operator==(const FloatMode& a, const FloatMode& b);

/// What `mode` does that the standard one doesn't: "flush-to-zero and denormals-are-zero", "rounding towards zero",
/// "traps on division by zero". Empty for the standard mode.
std::string describe(const FloatMode& mode);
/// It flushes denormal numbers, which is what start-up code of -ffast-math sets.
bool is_fast_math(const FloatMode& mode);

/// The standard mode as long as it lives; then the thread has again what it had. The program around a run may have
/// another one of its own.
class [[nodiscard]] StandardFloatMode {
 public:
  StandardFloatMode() : before_(float_mode()) {
    if (!(before_ == FloatMode())) set_float_mode({});  // to set it costs more than to look
  }
  ~StandardFloatMode() {
    if (!(before_ == FloatMode())) set_float_mode(before_);
  }
  StandardFloatMode(const StandardFloatMode&) = delete;
  StandardFloatMode& operator=(const StandardFloatMode&) = delete;

  /// A remark for the run, if the program had another mode.
  Diagnostics remarks() const;

 private:
  FloatMode before_;
};

}  // namespace rehearse
