// The log of the interposer in a file mapped into memory. So its contents survive every end of the process, and there
// is no open descriptor that a controller could close.
//
// A header, a table of entries, a heap of texts. Little-endian, in the byte order of the machine that wrote it, because
// it is read on this machine soon afterwards.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rehearse::interposer {

inline constexpr char log_magic[8] = {'R', 'H', 'C', 'A', 'L', 'L', 'S', '1'};
inline constexpr std::uint32_t max_entries = 2048;
inline constexpr std::uint32_t max_chain = 6;
inline constexpr std::uint32_t max_outer = 6;
inline constexpr std::uint32_t heap_size = 1u << 20;

/// Offset in the heap of a text with its final zero; 0: the empty text.
using TextOffset = std::uint32_t;

struct LoggedPlace {
  TextOffset module;
  std::uint32_t unused;
  std::uint64_t offset;  // virtual address in the module
};

struct LogEntry {
  std::uint32_t source;  // ObservedCall::Source
  TextOffset function;
  TextOffset argument;
  TextOffset controller;
  TextOffset phase;
  TextOffset digest;
  std::uint32_t chain_length;
  std::uint32_t outer_length;
  std::int64_t first_tick;
  std::int64_t last_tick;
  std::int64_t count;
  std::uint64_t key;  // hash of all fields that distinguish entries
  LoggedPlace place;
  LoggedPlace chain[max_chain];
  std::uint64_t outer[max_outer];  // addresses in the module of the place
};

struct Log {
  char magic[8];
  std::uint32_t entries;    // number of complete entries
  std::uint32_t heap_used;  // [bytes]
  std::uint32_t overflowed;
  std::uint32_t hidden;  // 1: a library makes system calls past the C library that can't be watched
  LogEntry entry[max_entries];
  char heap[heap_size];
};

}  // namespace rehearse::interposer
