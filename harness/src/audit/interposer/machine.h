// Files with facts of the machine, which an imaginary machine replaces.
#pragma once

namespace rehearse::interposer {

bool is_machine_file(const char* path);

/// Opens the replacement of a file with facts of the machine: a descriptor, or -1 and errno.
int open_machine_file(int machine, const char* path);

}  // namespace rehearse::interposer
