// The log of an interposed run: the calls of controllers to the system, and their places.
//
// The interposer (harness/interposer) writes it while the process runs; it is complete at any moment, also after a
// crash. It has one entry for each function, argument, place and phase, with the number of calls.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/host/interposer.h"

namespace rehearse {

struct ObservedCall {
  enum class Source { clock, random, thread, file, network, environment, locale, process, cost };

  Source source = Source::clock;
  std::string function;          // "clock_gettime"
  std::string argument;          // of `cost`: "allocation", ...; else "CLOCK_MONOTONIC", "HOME", "gains.txt"; empty: no
                                 // relevant argument
  std::string controller;        // "SR1/SR1Minimum"
  std::string phase;             // "load", "configure", "control", ...; "its own thread": on a thread it created
  std::int64_t first_tick = -1;  // -1: before the run
  std::int64_t last_tick = -1;
  std::int64_t count = 0;
  CodePlace place;                   // innermost place in the controller's library (else in a library that it loaded)
  std::vector<CodePlace> chain;      // from there to the function, innermost first; empty: called directly
  std::vector<std::uint64_t> outer;  // further addresses in that library, of the functions around the place
  std::string digest;                // of a file opened for reading: "214 bytes 8c7dd9...", "not there"; else empty
};

struct CallLog {
  std::vector<ObservedCall> calls;  // in order of their first occurrence
  bool hidden_calls = false;        // system calls past the C library were made and could not be watched
  bool complete = true;             // false: there were more kinds of calls than entries in the log
};

/// Reads the log of a process that has ended, in any way. Fails if the file can't be read or is no log.
Result<CallLog> read_call_log(const std::filesystem::path& file);

/// "clock", "random", ...
std::string_view to_string(ObservedCall::Source source);

/// "clock_gettime(CLOCK_MONOTONIC)"
std::string text_of(const ObservedCall& call);

/// "Filter::update() (filter.cpp:31)" by the library's symbols and debug information; without them at least
/// "BadFilter.so+0x1139".
std::string place_of(const ObservedCall& call);

}  // namespace rehearse
