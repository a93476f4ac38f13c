// Breakpoints in the libraries of controllers, which find out the tick in which each statement runs first.
//
// A breakpoint is the instruction INT3 in place of the first byte of another instruction. Its signal, SIGTRAP, is
// handled in this process. The breakpoint of a statement is removed when it is reached. So it costs time once, and the
// controller needs no special build. The breakpoint of a conditional jump stays until the jump has gone both ways. The
// handler then executes the jump itself, by the flags of the processor ("Intel 64 and IA-32 Architectures Software
// Developer's Manual", volume 2, Jcc).
#pragma once

#include <rehearse/coverage.h>
#include <rehearse/diagnostic.h>

#include <cstdint>
#include <filesystem>
#include <map>

namespace rehearse {

/// Prepares breakpoints for a library, which the dynamic linker will load. They are set before its first function
/// runs. Does nothing for a library that it already knows. Fails as map_code(), and on other processors than x86-64.
Result<void> watch_library(const std::filesystem::path& library);

/// The tick of the code that runs from now on; -1: before the run.
void set_watched_tick(std::int64_t tick);

/// The code of all watched libraries that has run, by their files. A library whose pages can't be written has none.
std::map<std::filesystem::path, ExecutedCode> executed_code();

}  // namespace rehearse
