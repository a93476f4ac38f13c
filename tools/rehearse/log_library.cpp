#include "log_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <filesystem>
#include <string>

#include "command.h"
#include "core/guard/own_library.h"
#include "core/mcap/container.h"
#include "wings.h"

namespace rehearse::tool {
namespace {

/// Reads by the library's reader, which takes the place of this one.
class LateReader : public mcap::ContainerReader {
 public:
  Result<mcap::ConvertedPtr> convert_file(mcap::Container container, mcap::Bytes bytes, const std::string& name,
                                          const std::filesystem::path& path) const override {
    const auto reader = REHEARSE_TRY(load(name));
    return reader->convert_file(container, bytes, name, path);
  }
  Result<mcap::OpenedFolder> open_folder(const std::filesystem::path& folder, const std::string& name) const override {
    const auto reader = REHEARSE_TRY(load(name));
    return reader->open_folder(folder, name);
  }

 private:
  static Result<const mcap::ContainerReader*> load(const std::string& log) {
    const std::filesystem::path file = own_library_folder() / ("librehearse_logs.so." REHEARSE_SOVERSION);
    void* library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);  // stays loaded
    void* function = library ? ::dlsym(library, "rehearse_read_logs") : nullptr;
    if (!function)
      return error_in(log, fmt::format("it needs the wing logs: {}", ::dlerror()),
                      "tools/build release rehearse-logs builds it");
    reinterpret_cast<void (*)()>(function)();
    return mcap::container_reader();
  }
};

}  // namespace

void open_logs_when_needed() {
  static const LateReader reader;
  if constexpr (has_logs) mcap::set_container_reader(reader);
}

}  // namespace rehearse::tool
