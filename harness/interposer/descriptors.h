// The file descriptors of the host.
#pragma once

namespace rehearse::interposer {

/// Stores the descriptors that are open now, before any code of a controller has run.
void remember_open_descriptors();

/// Notes that the controller has opened this descriptor, and returns it.
int now_controllers(int descriptor);

}  // namespace rehearse::interposer
