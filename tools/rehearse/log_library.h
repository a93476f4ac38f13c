// Logs in other containers than MCAP (rosbag2, bags of ROS 1), for programs that don't link the wing logs.
#pragma once

namespace rehearse::tool {

/// From now on this process opens such logs by librehearse_logs, which it loads with the first of them: SQLite alone
/// has a sixth of the names that the start of a program looks up. Without the library the log is refused, with the
/// reason.
void open_logs_when_needed();

}  // namespace rehearse::tool
