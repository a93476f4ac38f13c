// Files that another program cuts while they are mapped. Reading behind their new end raises SIGBUS, which would end
// the process; instead zeros are read there, and the reader is told. Internal.
#pragma once

#include <rehearse/mcap.h>

namespace rehearse::mcap {

/// From now on reading these mapped bytes survives. Of more than 256 files at a time the others aren't watched.
void watch_for_cut(Bytes mapped);
/// Before they are unmapped.
void end_watch(Bytes mapped);
/// Whether bytes of a watched file were read that are gone.
bool was_cut(Bytes mapped);

}  // namespace rehearse::mcap
