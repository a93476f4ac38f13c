// The file descriptors of the host.
#pragma once

namespace rehearse::interposer {

/// Stores the descriptors that are open now, before any code of a controller has run.
void remember_open_descriptors();

/// Notes that the controller has opened this descriptor, and returns it.
int now_controllers(int descriptor);

/// The name by which a controller opened a file, if it is relative to the working folder; else empty.
const char* relative_name_of(int descriptor);
void set_relative_name(int descriptor, const char* name);

}  // namespace rehearse::interposer
