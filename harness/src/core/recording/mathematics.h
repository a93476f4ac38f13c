// The mathematics of the processor: which variants of sin, exp and so on the C library takes.
#pragma once

#include <string>

namespace rehearse {

/// The features of this machine's processor by which libm chooses its functions: "avx2 fma". Empty: it isn't known.
std::string mathematics_of_processor();

}  // namespace rehearse
