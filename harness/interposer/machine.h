// Files that say something of the machine, and of which an imaginary machine has its own.
#pragma once

namespace rehearse::interposer {

bool is_machine_file(const char* path);

/// What is opened in the place of such a file: a descriptor, or -1 and errno.
int open_machine_file(int machine, const char* path);

}  // namespace rehearse::interposer
