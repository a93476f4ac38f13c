// The notes of a supervised process for its parent, in memory that both share. Internal.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <string>

#include "base/hashing.h"

namespace rehearse {

/// A call into a controller.
struct NotedCall {
  std::int64_t tick = 0;
  double time = 0.0;   // [s] of simulation
  double limit = 0.0;  // [s]
  char controller[256] = {};
  char function[64] = {};
};

/// A call and its hash: a controller may write into the memory that parent and child share.
struct SealedCall {
  NotedCall call;
  std::uint64_t seal = 0;

  std::uint64_t right_seal() const { return hash_bytes(&call, sizeof call, 1); }
};

/// A number that a stray write hardly gives.
inline constexpr std::uint64_t regular_end = 0x72656775'6c617221;

/// Memory that parent and child share. The child writes, and may be killed at any time. A controller may write there,
/// so it has no types whose bytes may be invalid.
struct Notes {
  std::atomic<std::uint64_t> calls{0};      // number of begins and ends; odd: a call is running
  std::array<SealedCall, 2> last_calls;     // written in turns: a kill leaves one of them whole
  std::atomic<std::uint32_t> latest{0};     // index of the last call
  std::atomic<std::uint64_t> announced{0};  // regular_end: the end was announced
  int status = 0;                           // the announced exit status
  std::atomic<double> memory_limit{0.0};    // [bytes]; 0: not stated
  int tasks_left = 0;
  char task[512] = {};
  char deed[512] = {};                 // after the controller's name: how its call failed
  char library[1024] = {};             // of the code that failed; empty: not known
  std::uintptr_t address = 0;          // of that code in the library
  std::atomic<std::uint32_t> hung{0};  // 1: the call exceeded its limit
  int checks_leaks = 0;                // 1: a leak checker may change the exit status in exit()
  std::atomic<std::int32_t> run{0};    // the process of the present run, a child of the child; 0: the child makes it
};

template <std::size_t size>
void put(char (&place)[size], const char* text) {
  const std::size_t length = strnlen(text, size - 1);
  std::memcpy(place, text, length);
  place[length] = '\0';
}

/// A guest may have written into the notes.
template <std::size_t size>
std::string text_of(const char (&place)[size]) {
  return std::string(place, strnlen(place, size));
}

}  // namespace rehearse
