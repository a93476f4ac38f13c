#include "float_mode.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fpu_control.h>

#include <vector>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace rehearse {
namespace {

constexpr unsigned int sticky_flags = 0x3f;  // flags such as "inexact": they record events and are no mode
constexpr unsigned int denormals_are_zero = 0x0040;
constexpr unsigned int flush_to_zero = 0x8000;

const char* name_of_rounding(unsigned int bits) {
  switch (bits) {
    case 1: return "rounding down";
    case 2: return "rounding up";
    case 3: return "rounding towards zero";
    default: return nullptr;
  }
}

/// Adds the enabled traps of the processor. `masked`: a bit that is 0 enables a trap.
void add_traps(unsigned int masked, std::vector<std::string>& deeds) {
  constexpr const char* names[] = {"invalid operations", "denormal numbers", "division by zero",
                                   "overflow",           "underflow",        "inexact results"};
  std::vector<std::string> trapped;
  for (unsigned int bit = 0; bit < 6; ++bit)
    if (!(masked >> bit & 1U)) trapped.emplace_back(names[bit]);
  if (!trapped.empty()) deeds.push_back(fmt::format("traps on {}", fmt::join(trapped, ", ")));
}

}  // namespace

#if defined(__x86_64__)
FloatMode float_mode() {
  FloatMode mode;
  mode.sse = _mm_getcsr() & ~sticky_flags;
  _FPU_GETCW(mode.x87);
  return mode;
}

void set_float_mode(const FloatMode& mode) {
  _mm_setcsr(mode.sse);
  _FPU_SETCW(mode.x87);
}
#elif defined(__aarch64__)
namespace {

/// A bit of arm64's FPCR, and the same mode in MXCSR. A trap is enabled by 1 there, and by 0 here.
struct SameBit {
  unsigned int fpcr, mxcsr;
  bool enables = true;
};
constexpr SameBit same_bits[] = {{1U << 24, flush_to_zero | denormals_are_zero},
                                 {1U << 22, 2U << 13},  // rounding up
                                 {1U << 23, 1U << 13},  // rounding down
                                 {1U << 8, 1U << 7, false},
                                 {1U << 15, 1U << 8, false},
                                 {1U << 9, 1U << 9, false},
                                 {1U << 10, 1U << 10, false},
                                 {1U << 11, 1U << 11, false},
                                 {1U << 12, 1U << 12, false}};

}  // namespace

FloatMode float_mode() {
  fpu_control_t fpcr = 0;
  _FPU_GETCW(fpcr);
  FloatMode mode;
  mode.sse = 0;
  for (const SameBit& bit : same_bits)
    if (((fpcr & bit.fpcr) != 0) == bit.enables) mode.sse |= bit.mxcsr;
  return mode;
}

void set_float_mode(const FloatMode& mode) {
  fpu_control_t fpcr = 0;
  for (const SameBit& bit : same_bits)
    if (((mode.sse & bit.mxcsr) != 0) == bit.enables) fpcr |= bit.fpcr;
  _FPU_SETCW(fpcr);
}
#else
#error "the floating-point mode of this processor isn't known: see harness/src/core/guard/float_mode.cpp"
#endif

bool is_fast_math(const FloatMode& mode) { return mode.sse & (flush_to_zero | denormals_are_zero); }

std::string describe(const FloatMode& mode) {
  std::vector<std::string> deeds;
  if (mode.sse & flush_to_zero) deeds.emplace_back("flush-to-zero");
  if (mode.sse & denormals_are_zero) deeds.emplace_back("denormals-are-zero");
  if (const char* rounding = name_of_rounding(mode.sse >> 13 & 3U)) deeds.emplace_back(rounding);
  add_traps(mode.sse >> 7 & 0x3fU, deeds);
  const unsigned int x87 = mode.x87;
  const FloatMode standard;
  if ((x87 >> 10 & 3U) != (mode.sse >> 13 & 3U) && name_of_rounding(x87 >> 10 & 3U))
    deeds.push_back(fmt::format("{} in the x87", name_of_rounding(x87 >> 10 & 3U)));
  if ((x87 >> 8 & 3U) != (standard.x87 >> 8 & 3U)) deeds.emplace_back("less precision in the x87");
  if ((x87 & 0x3fU) != 0x3fU && (mode.sse >> 7 & 0x3fU) == 0x3fU) deeds.emplace_back("traps in the x87");
  if (deeds.empty()) return {};
  const std::string last = deeds.back();
  deeds.pop_back();
  return deeds.empty() ? last : fmt::format("{} and {}", fmt::join(deeds, ", "), last);
}

Diagnostics StandardFloatMode::remarks() const {
  if (before_ == FloatMode()) return {};
  Diagnostic remark =
      warning(fmt::format("this process was in another floating-point mode ({}) before the run; the run was "
                          "made in the standard one",
                          describe(before_)));
  if (is_fast_math(before_)) remark.hint = "is the program, or a library of it, linked with -ffast-math?";
  return {remark};
}

}  // namespace rehearse
