// Pinning: a process whose arithmetic doesn't depend on the processor it runs on.
//
// The C library chooses its implementation of sin, exp and so on by the features of the processor. The renderer
// compiles its shaders for the processor. So both round differently on different machines. Both read settings from the
// environment, before a program starts. A program that needs the same bits everywhere therefore starts itself once more
// with these settings.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {

/// The variables that pin a process, with their values: GLIBC_TUNABLES for the C library's mathematics,
/// GALLIUM_OVERRIDE_CPU_CAPS and LP_NUM_THREADS for the renderer.
std::vector<std::pair<std::string, std::string>> pinned_environment();

/// True if this process was started with the pinned environment; later changes of its environment have no effect.
bool is_pinned();

/// "yes", or "no" and the reason: the fact `pinned` in recordings of this process.
std::string pinned_fact();

/// Sets these variables for the programs that this process starts (exec) from now on; it has no effect on this process.
void set_pinned_environment();

/// True if REHEARSE_PIN=off is set: this process and its children must not pin themselves.
bool is_pinning_off();

/// The file of this program; without /proc, the name by which it was started.
std::filesystem::path own_program();

/// True under valgrind: this program can't start itself again and stay under valgrind, unless valgrind follows
/// children.
bool runs_under_valgrind();

/// Must be called first in main(), before any computation. Unless the process is already pinned, it executes this
/// program once more, with the same arguments and the pinned environment. Returns if the process was pinned, if
/// REHEARSE_PIN=off is set, or if the second start fails (then is_pinned() is false, and recordings state this). A
/// value of REHEARSE_PIN other than `on` and `off` ends the program with a message and exit status 2.
void pin_process(char** argv);

}  // namespace rehearse
