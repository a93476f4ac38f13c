// Exports a recording for viewers: Foxglove, Lichtblick, PlotJuggler, RViz.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace rehearse {

struct ViewerOptions {
  bool contacts = false;  // markers of contacts, as arrows of their forces
};

struct ViewerReport {
  std::uint64_t messages = 0;       // number of messages of all topics
  std::vector<std::string> topics;  // added topics
  std::vector<std::string> frames;  // frames in /tf_static
  Diagnostics remarks;              // bodies without a description
};

/// Writes an MCAP file with all messages of the recording and the data that a viewer needs to show the robot. The
/// added data has the time of the first message:
/// - /robot_description (std_msgs/String) of the first body with a controller, and /BODY/robot_description of each
///   body: its URDF, with links named as the frames in /tf (BODY/LINK). An inline shape gets a URDF of its own;
/// - /tf_static: the frame of every device, BODY/DEVICE, in its link's frame; of a camera as in ROS, z ahead, x right;
/// - /rosout (rcl_interfaces/Log): the events, with the lines of controllers;
/// - with `contacts`, for each topic of contacts a topic with /markers at its end (visualization_msgs/MarkerArray): an
///   arrow for each recorded force.
/// In /tf a link's pose is relative to its parent, as in the description; in the recording it is in the world.
/// Fails if the file is no recording of Rehearse.
Result<ViewerReport> export_for_viewer(const std::filesystem::path& trace, const std::filesystem::path& file,
                                       const ViewerOptions& options);

/// Writes a layout: .json for Foxglove and Lichtblick (a 3D panel that follows the robot, a picture for each camera,
/// plots of the joints, the log), .xml for PlotJuggler (a tab with the joints and their commands of each body). It
/// works with the recording itself, and shows more of the file of export_for_viewer().
Result<void> write_layout(const std::filesystem::path& trace, const std::filesystem::path& file);

/// Writes the files that a recording contains about its robots into a folder: scenario.yaml, models under their names
/// without the folders above, and meshes.txt, the names and hashes of their meshes. Returns the files.
Result<std::vector<std::filesystem::path>> export_robot(const std::filesystem::path& trace,
                                                        const std::filesystem::path& folder);

}  // namespace rehearse
