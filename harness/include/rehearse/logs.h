// Logs of other programs than Rehearse.
#pragma once

namespace rehearse {

/// From now on this process opens folders and databases of rosbag2, and files compressed by zstd, wherever it opens an
/// MCAP file: Trace::load(), mcap::Reader::open(), compare() and others. A program calls it once, in main().
void read_rosbag2_logs();

}  // namespace rehearse
