// The cost of pinning can't be measured in one process, which is either pinned or not. So two child processes do the
// same work in turns, on request.
#pragma once

#include <functional>
#include <string>

namespace rehearse {

/// Work that a child does at each request.
using Work = std::function<void()>;

Work make_closed_loop_work();     // 100 ticks of SR1 recorded without cameras
Work make_recorded_frame_work();  // a picture of each of SR1's cameras, drawn and recorded

/// main() of a child: does the work for each byte on stdin, and answers with a byte on stdout. Returns an exit status
/// at the end of stdin.
int run_child(const std::string& work);

}  // namespace rehearse
