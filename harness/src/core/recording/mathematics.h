// The mathematics of the processor: which variants of sin, exp and so on the C library takes.
#pragma once

#include <rehearse/mcap_types.h>

#include <string>

namespace rehearse {

/// The features of this machine's processor by which libm chooses its functions: "avx2 fma". Empty: it isn't known.
std::string mathematics_of_processor();

/// Why this process may compute other last bits than the loop with these facts of a flight (records::flight): "the
/// loop's processor has avx2 fma, and this one avx". Empty: it computes with the same functions.
std::string other_mathematics(const mcap::StringMap& flight);

}  // namespace rehearse
