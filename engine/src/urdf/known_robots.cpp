#include "known_robots.h"

#include <atomic>
#include <tuple>

namespace rehearse::urdf {
namespace {

constexpr std::size_t largest_text = 1 << 20;  // [bytes]
constexpr std::size_t most_robots = 8;

std::atomic<std::uint64_t> read_so_far{0};

/// All members, so that a new one has to be named here.
auto members_of(const UrdfOptions& options) {
  const auto& [strict, packages, compare, missing_meshes, z_up, unknown_devices, unsupported, meshes, contact, fixed,
               kinematic, mass] = options;
  return std::tie(strict, packages, compare, missing_meshes, z_up, unknown_devices, unsupported, meshes, contact, fixed,
                  kinematic, mass);
}

}  // namespace

KnownRobots& KnownRobots::of_process() {
  static auto& robots = *new KnownRobots;
  return robots;
}

bool KnownRobots::can_keep(const std::string& text, const UrdfOptions& options) {
  return text.size() <= largest_text &&
         (options.meshes == UrdfOptions::Meshes::skip || text.find("filename") == std::string::npos);
}

std::optional<Model> KnownRobots::find(const std::string& text, const std::string& name, const UrdfOptions& options) {
  const std::lock_guard lock(mutex_);
  for (const Robot& robot : robots_)
    if (robot.model.source_file == name && robot.model.source_text == text &&
        members_of(robot.options) == members_of(options))
      return robot.model;
  return std::nullopt;
}

void KnownRobots::keep(const Model& model, const UrdfOptions& options) {
  const std::lock_guard lock(mutex_);
  if (robots_.size() == most_robots) robots_.pop_front();
  robots_.push_back({model, options});
}

std::uint64_t robots_read() { return read_so_far; }

void count_robot() { ++read_so_far; }

}  // namespace rehearse::urdf
