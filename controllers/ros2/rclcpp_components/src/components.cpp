#include <dlfcn.h>
#include <link.h>

#include <algorithm>
#include <mutex>

#include "rclcpp_components/register_node_macro.hpp"

namespace rclcpp_components {
namespace {

struct Entry {
  const RehearseComponent* component;
  std::string name;
  RehearseMaker maker;
};

std::mutex& entries_mutex() {
  static std::mutex mutex;
  return mutex;
}
std::vector<Entry>& entries() {
  static std::vector<Entry> all;
  return all;
}

/// True if the library contains the code.
bool is_in(void* handle, RehearseMaker maker) {
  const link_map* map = nullptr;
  Dl_info place{};
  if (dlinfo(handle, RTLD_DI_LINKMAP, &map) != 0 || dladdr(reinterpret_cast<const void*>(maker), &place) == 0)
    return false;
  return reinterpret_cast<ElfW(Addr)>(place.dli_fbase) == map->l_addr;
}

}  // namespace

RehearseComponent::RehearseComponent(const char* name, RehearseMaker maker) {
  const std::lock_guard lock(entries_mutex());
  entries().push_back({this, name, maker});
}

RehearseComponent::~RehearseComponent() {
  const std::lock_guard lock(entries_mutex());
  auto& all = entries();
  all.erase(std::remove_if(all.begin(), all.end(), [this](const Entry& entry) { return entry.component == this; }),
            all.end());
}

RehearseMaker rehearse_find_component(void* handle, const std::string& name) {
  const std::lock_guard lock(entries_mutex());
  for (const Entry& entry : entries())
    if (entry.name == name && is_in(handle, entry.maker)) return entry.maker;
  return nullptr;
}

std::vector<std::string> rehearse_components_of(void* handle) {
  const std::lock_guard lock(entries_mutex());
  std::vector<std::string> names;
  for (const Entry& entry : entries())
    if (is_in(handle, entry.maker)) names.push_back(entry.name);
  return names;
}

}  // namespace rclcpp_components
