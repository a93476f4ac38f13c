// The scan of a controller's library, without running it: the flags it was linked with, its instructions, the functions
// it can call.
#pragma once

#include <rehearse/audit.h>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "call_log.h"

namespace rehearse {

/// The kind of a finding in a library.
enum class CodeKind {
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

/// "fast_math_startup", ...
std::string_view to_string(CodeKind kind);

/// The findings, in order of kind, then of name. Fails if the file can't be read, is no shared library for x86-64, or
/// contradicts itself.
Result<std::vector<AuditedCode>> scan_library(const std::filesystem::path& file);

/// A system function whose answer isn't an input of a controller.
struct SymbolSource {
  ObservedCall::Source source;
  std::string name;  // as people call it: "clock_gettime", "std::random_device"
};

/// The kind of source of a symbol, by the name under which a library imports it; none: not a known source.
std::optional<SymbolSource> source_of_symbol(std::string_view symbol);

}  // namespace rehearse
