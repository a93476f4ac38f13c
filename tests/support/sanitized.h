// Whether this program is built with AddressSanitizer, in whose builds threads of controllers are free.
#pragma once

namespace rehearse::test {

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool is_sanitized = true;
#elif defined(__has_feature)
inline constexpr bool is_sanitized = __has_feature(address_sanitizer);
#else
inline constexpr bool is_sanitized = false;
#endif

inline constexpr const char* why_free = "threads take turns in builds without sanitizers";

}  // namespace rehearse::test
