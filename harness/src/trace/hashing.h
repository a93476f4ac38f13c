// hash_bytes: the one hash of a run (XXH3, 64 bits): the same bytes, the same number, on every machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace rehearse {

std::uint64_t hash_bytes(const void* data, std::size_t size, std::uint64_t seed = 0);

/// 16 hexadecimal digits.
std::string hash_text(std::uint64_t hash);

}  // namespace rehearse
