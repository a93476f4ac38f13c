// The scan of a controller's library, without running it: the flags it was linked with, its instructions, the functions
// it can call.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "call_log.h"

namespace rehearse {

struct LibraryFinding {
  enum class Kind {
    fast_math_startup,   // loading it switches the process to flush-to-zero
    float_mode_change,   // ldmxcsr, fldcw elsewhere: calling it may do so
    fused_arithmetic,    // vfmadd and similar: they round once where two instructions round twice
    approximation,       // rcpps, rsqrtps, fsin and similar: their last bits differ between processor makers
    time_stamp_counter,  // rdtsc, rdtscp
    hardware_random,     // rdrand, rdseed
    processor_query,     // cpuid, xgetbv: the code's behaviour may depend on the processor
    direct_syscall,      // past the C library, so that calls aren't observed
    imported_source,     // a function of the system whose answer isn't an input
  };
  Kind kind = Kind::fast_math_startup;
  std::optional<ObservedCall::Source> source;  // of imported_source
  std::int64_t count = 0;                      // instructions; 1 for a start-up function or an import
  std::string function;  // the first function that contains one, demangled; for imported_source the imported function
  std::string place;     // "filter.cpp:31" if there is debug information, else "BadFilter.so+0x1139"; of imports: empty
  std::string sentence;  // for a person, complete
};

struct LibraryScan {
  std::vector<LibraryFinding> findings;  // in order of kind, then of name
  bool has_debug_information = false;
  bool is_stripped = false;
};

/// Fails if the file can't be read, is no shared library for x86-64, or contradicts itself.
Result<LibraryScan> scan_library(const std::filesystem::path& file);

/// "fast_math_startup", ...
std::string_view to_string(LibraryFinding::Kind kind);

}  // namespace rehearse
