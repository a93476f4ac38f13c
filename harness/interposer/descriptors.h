// Which file descriptors belong to the host.
#pragma once

namespace rehearse::interposer {

/// Those that are open now: nothing of a controller has run yet.
void remember_open_descriptors();

/// The controller has opened this one; returned as it is.
int now_controllers(int descriptor);

}  // namespace rehearse::interposer
