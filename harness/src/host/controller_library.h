// ControllerLibrary: a controller's shared library, found, loaded and asked for its factory.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "process_guard.h"

namespace cnoid {
class SimpleController;
}

namespace rehearse {

/// Finds the file of a library. `name` with a slash or the ending .so is a path, relative to `directory`, else to the
/// working directory. Any other name is looked for as NAME.so and libNAME.so in the folders of REHEARSE_CONTROLLER_PATH
/// (separated by colons), then in the builds of the project that `directory` or the working directory is of (the newest
/// first; not by a program that was built there: then in its own build alone), then in lib/rehearse/controllers beside
/// this library. Fails saying where it looked.
Result<std::filesystem::path> find_controller_library(const std::string& name, const std::filesystem::path& directory);

/// What provenance says of a library's file: 16 hexadecimal digits (XXH3) of its bytes.
std::string content_hash_of(const std::filesystem::path& file);

/// The folder that holds our own shared libraries; empty if it can't be told.
std::filesystem::path own_library_folder();

class ControllerLibrary {
 public:
  /// Loads the file. Fails if it can't be loaded (naming an undefined symbol as its author wrote it) or is no
  /// controller. The code that runs while it loads may take `call_limit` seconds.
  static Result<std::shared_ptr<ControllerLibrary>> open(const std::filesystem::path& file, double call_limit);
  ~ControllerLibrary();
  ControllerLibrary(const ControllerLibrary&) = delete;
  ControllerLibrary& operator=(const ControllerLibrary&) = delete;

  /// A new controller. Runs the library's code: to be called under guard.
  cnoid::SimpleController* create() const { return factory_(); }

  const std::filesystem::path& file() const { return file_; }
  /// content_hash_of() its file.
  const std::string& content_hash() const { return content_hash_; }
  /// What it did to the process while it was loaded, and what was done about that.
  const std::vector<std::string>& remarks() const { return remarks_; }
  /// How many threads its code has started that still run.
  const ThreadCount& threads() const { return threads_; }
  /// Leaves the library in memory for good: its code crashed or never returned, and may not be unloaded.
  void keep_loaded();

 private:
  ControllerLibrary() = default;
  using Factory = cnoid::SimpleController* (*)();
  std::filesystem::path file_;
  std::string content_hash_;
  double call_limit_ = 0.0;  // [s]
  void* handle_ = nullptr;
  Factory factory_ = nullptr;
  bool keep_loaded_ = false;
  std::vector<std::string> remarks_;
  ThreadCount threads_ = std::make_shared<std::atomic<int>>(0);
};

}  // namespace rehearse
