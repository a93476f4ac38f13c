// The code of a controller in which a signal came, or which called the function in which it came. Internal.
#pragma once

#include "core/turns/scheduler.h"

namespace rehearse {

/// In a signal handler: the place of the nearest call of this thread's stack that lies in a library of a controller;
/// `interrupted` itself if it lies there, or if there is no such call. Allocates nothing and takes no lock, because the
/// interrupted code may hold any.
const void* guest_frame_of(const void* interrupted);

/// First in a signal handler: doesn't return if the signal came in guest_frame_of(), which a damaged stack can cause;
/// then that ends without a call.
void end_walk_of_frames();

/// The places of the nearest calls of this thread's stack that lie in libraries of controllers. Not in a signal
/// handler.
CodePlaces guest_frames();

/// Must be called before guest_frame_of(), outside of a signal handler.
void prepare_guest_frames();

}  // namespace rehearse
