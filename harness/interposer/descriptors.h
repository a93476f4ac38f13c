// Which file descriptors belong to the host.
#pragma once

namespace rehearse::interposer {

/// Those that are open now: nothing of a controller has run yet.
void remember_open_descriptors();

}  // namespace rehearse::interposer
