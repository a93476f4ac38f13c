// What pinning costs can't be measured in one process: a process is pinned or not. So two children do the same work in
// turns, each time when they are told.
#pragma once

#include <functional>
#include <string>

namespace rehearse {

/// Work that a child does each time it is asked.
using Work = std::function<void()>;

Work make_closed_loop_work();     // 100 ticks of SR1 recorded without cameras
Work make_recorded_frame_work();  // a picture of each of SR1's cameras, drawn and recorded

/// main() of a child: does that work for each byte on stdin, and answers with a byte on stdout. Returns at the end of
/// stdin, with an exit status.
int run_child(const std::string& work);

}  // namespace rehearse
