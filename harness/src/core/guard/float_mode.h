// The floating-point mode of a thread: the processor's handling of rounding, denormal numbers and invalid operations.
//
// Every thread has its own mode; a new thread starts with the mode of its parent. A library linked with -ffast-math
// changes the mode of the thread that loads it. A whole run is computed in the standard mode of IEEE 754.
#pragma once

#include <rehearse/diagnostic.h>

#include <string>

namespace rehearse {

struct FloatMode {
  unsigned int sse = 0x1f80;    // MXCSR without its sticky exception flags; on arm64 FPCR in the form of MXCSR
  unsigned short x87 = 0x037f;  // the control word of the x87, which computes long double; constant on arm64

  bool operator==(const FloatMode&) const = default;
};

/// The mode of this thread.
FloatMode float_mode();
void set_float_mode(const FloatMode& mode);

/// The differences of `mode` from the standard mode: "flush-to-zero and denormals-are-zero", "rounding towards zero",
/// "traps on division by zero". Empty for the standard mode.
std::string describe(const FloatMode& mode);
/// True if it flushes denormal numbers, as start-up code of -ffast-math does.
bool is_fast_math(const FloatMode& mode);

/// Sets the standard mode during its lifetime, then restores the thread's previous mode. The program around a run may
/// use a different mode.
class [[nodiscard]] StandardFloatMode {
 public:
  StandardFloatMode() : before_(float_mode()) {
    if (!(before_ == FloatMode())) set_float_mode({});  // setting it is slower than reading it
  }
  ~StandardFloatMode() {
    if (!(before_ == FloatMode())) set_float_mode(before_);
  }
  StandardFloatMode(const StandardFloatMode&) = delete;
  StandardFloatMode& operator=(const StandardFloatMode&) = delete;

  /// A remark for the run, if the program had a different mode.
  Diagnostics remarks() const;

 private:
  FloatMode before_;
};

}  // namespace rehearse
