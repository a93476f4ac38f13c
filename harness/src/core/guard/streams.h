// Streams: stdin, stdout and stderr of a process with controllers, which may close or redirect them.
#pragma once

#include <sys/types.h>

namespace rehearse {

/// Notes the present files of the streams, and of the kept stdout (result_stream.h). `parent`: a process that has them,
/// too.
void note_streams(pid_t parent);

/// Opens the streams again if a controller has closed or redirected them. True: it had. Without note_streams() it has
/// no effect.
bool restore_streams();

}  // namespace rehearse
