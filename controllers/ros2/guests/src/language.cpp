// librehearse_guests.so: runs nodes of ROS 2. The host of controllers loads it for names such as
// libbalance.so:balance::Balance.
#include "core/host/language_functions.h"

#include <dlfcn.h>

#include <string>

#include "guest.h"

namespace rehearse::ros2 {
namespace {

struct Loaded {
  void* handle = nullptr;
  rclcpp_components::RehearseMaker maker = nullptr;
};

void* load(const char* file, const char* entry, LanguageProblem& problem) {
  void* const handle = dlopen(file, RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    problem.message = dlerror();
    problem.hint = "build it against this installation: source its setup.sh, then colcon build";
    return nullptr;
  }
  if (const auto maker = rclcpp_components::rehearse_find_component(handle, entry)) return new Loaded{handle, maker};
  problem.message = "the library has no component '" + std::string(entry) + "'";
  for (const std::string& name : rclcpp_components::rehearse_components_of(handle))
    problem.hint += (problem.hint.empty() ? "it has " : ", ") + name;
  if (problem.hint.empty()) problem.hint = "register it with RCLCPP_COMPONENTS_REGISTER_NODE";
  dlclose(handle);
  return nullptr;
}

void list_files(const char* file, void (*add)(void*, const char*), void* context) { add(context, file); }

const rehearse_controller_functions* functions_of_loaded(void* loaded) {
  const auto maker = static_cast<Loaded*>(loaded)->maker;
  return functions_of([maker](const rclcpp::NodeOptions& options) { return maker()->create_node_instance(options); });
}

void unload(void* loaded) {
  dlclose(static_cast<Loaded*>(loaded)->handle);
  delete static_cast<Loaded*>(loaded);
}

void* handle_of(void* loaded) { return static_cast<Loaded*>(loaded)->handle; }

}  // namespace
}  // namespace rehearse::ros2

extern "C" __attribute__((visibility("default"))) const rehearse::LanguageFunctions rehearse_language = {
    rehearse::language_functions_version, &rehearse::ros2::load,   &rehearse::ros2::list_files,
    &rehearse::ros2::functions_of_loaded, &rehearse::ros2::unload, &rehearse::ros2::handle_of};
