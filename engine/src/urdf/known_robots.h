// The robots that this process has read last.
#pragma once

#include <rehearse/urdf.h>

#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

namespace rehearse::urdf {

/// The scenarios of a project often share a robot, and each recording has its text again.
class KnownRobots {
 public:
  static KnownRobots& of_process();
  /// True if nothing but the text, the name and the options decides what is read. A URDF names other files by
  /// `filename`.
  static bool can_keep(const std::string& text, const UrdfOptions& options);

  std::optional<Model> find(const std::string& text, const std::string& name, const UrdfOptions& options);
  void keep(const Model& model, const UrdfOptions& options);

 private:
  struct Robot {
    Model model;
    UrdfOptions options;
  };

  std::mutex mutex_;
  std::deque<Robot> robots_;
};

/// The number of texts that parse_urdf() has read in this process, without those that it knew.
std::uint64_t robots_read();
/// Adds one to robots_read().
void count_robot();

}  // namespace rehearse::urdf
