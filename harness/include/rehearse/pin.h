// Pinning: a process whose arithmetic doesn't depend on the processor it runs on.
//
// The C library chooses its sin, exp and so on by what the processor can do, and the renderer compiles its shaders for
// it; both then round differently from machine to machine. Both take their orders from the environment, before a
// program starts. So a program that wants the same bits everywhere starts itself once more with that environment.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {

/// The variables that pin a process, with their values: GLIBC_TUNABLES for the C library's mathematics,
/// GALLIUM_OVERRIDE_CPU_CAPS and LP_NUM_THREADS for the renderer.
std::vector<std::pair<std::string, std::string>> pinned_environment();

/// True if this process was started with them; what it has set for itself since then has no effect.
bool is_pinned();

/// "yes", or "no" and why: what recordings say of this process as the fact `pinned`.
std::string pinned_fact();

/// Sets them for the programs that this one starts (exec) from now on; it does nothing to this one.
void set_pinned_environment();

/// REHEARSE_PIN=off is set: this process and those that it starts shall not pin themselves.
bool is_pinning_off();

/// The file of this program; where there is no /proc, the name by which it was started.
std::filesystem::path own_program();

/// Valgrind runs this program: it can't start itself again and stay under valgrind, unless that follows children.
bool runs_under_valgrind();

/// To be called first in main(), before anything computes: unless pinned already, executes this program once more, with
/// the same arguments and the pinned environment. Comes back if it was pinned, if REHEARSE_PIN=off says so, or if it
/// can't be done (then is_pinned() is false, and recordings say so). Another value of REHEARSE_PIN than `on` and `off`
/// ends the program with a message and exit status 2.
void pin_process(char** argv);

}  // namespace rehearse
