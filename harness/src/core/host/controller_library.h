// ControllerLibrary: finds and loads the shared library of a controller, and returns its factory.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/scenario.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/guard/process_guard.h"

namespace cnoid {
class SimpleController;
}
struct rehearse_controller_functions;
namespace rehearse {
struct HostedName;
struct LanguageFunctions;
struct LanguageProblem;
}  // namespace rehearse

namespace rehearse {

/// Finds the file of a library. `name` with a slash, with the ending .so or of a hosted language (FILE.py:CLASS, which
/// the result has, too; hosted_language.h) is a path, relative to `directory`, else to the
/// working directory. Any other name is searched as NAME.so and libNAME.so in three places. These are the folders of
/// REHEARSE_CONTROLLER_PATH (separated by colons), the builds of the project (the newest first), and
/// lib/rehearse/controllers beside this library. The project is that of `directory` or of the working directory. A
/// program that was built in the project searches its own build alone. Fails with the list of searched places.
Result<std::filesystem::path> find_controller_library(const std::string& name, const std::filesystem::path& directory);

/// Which build find_controller_library() takes the library from, where several builds of the project have it: the
/// folder and its type of build, the sanitizers of the library, the rule, and the other builds. Empty: there was no
/// choice.
std::string note_on_builds(const std::string& name, const std::filesystem::path& directory);

class ControllerLibrary {
 public:
  /// Loads the file for the controller `label` ("BODY/NAME"). Fails if it can't be loaded (the message has the C++ name
  /// of an undefined symbol) or is no controller. `call_limit` limits the time of the code that runs while it loads
  /// [s].
  static Result<std::shared_ptr<ControllerLibrary>> open(const std::filesystem::path& file, const std::string& label,
                                                         double call_limit, const ThreadRules& threads = {});
  ~ControllerLibrary();
  ControllerLibrary(const ControllerLibrary&) = delete;
  ControllerLibrary& operator=(const ControllerLibrary&) = delete;

  /// Creates a new controller. Runs the library's code: must be called in a guarded call.
  cnoid::SimpleController* create() const;

  const std::filesystem::path& file() const { return file_; }
  /// hash_of_controller() of the library's file.
  const std::string& content_hash() const { return content_hash_; }
  /// linked_libraries() of it; none of a hosted language whose controllers are no shared libraries.
  const std::map<std::string, std::string>& linked() const { return linked_; }
  /// Changes that the library made to the process while it was loaded, and their repair.
  const std::vector<std::string>& remarks() const { return remarks_; }
  /// The threads that its code has started.
  const ThreadCount& threads() const { return threads_; }
  /// Leaves the library in memory for good: its code crashed or never returned, so it must not be unloaded.
  void keep_loaded();

 private:
  ControllerLibrary() = default;
  using Factory = cnoid::SimpleController* (*)();
  /// Loads a controller of a hosted language; runs its author's code.
  LanguageProblem load_hosted(const HostedName& name);
  /// What the dynamic linker knows of the controller's library.
  void take_links(void* handle);
  void unload();
  std::filesystem::path file_;
  std::string label_;  // of the controller, for the report of a process that ends while the library is unloaded
  std::string content_hash_;
  std::map<std::string, std::string> linked_;
  double call_limit_ = 0.0;  // [s]
  void* handle_ = nullptr;
  Factory factory_ = nullptr;  // null: it is a controller in C
  const rehearse_controller_functions* c_functions_ = nullptr;
  const LanguageFunctions* language_ = nullptr;  // not null: it runs hosted_
  void* hosted_ = nullptr;
  bool keep_loaded_ = false;
  std::vector<std::string> remarks_;
  ThreadCount threads_ = std::make_shared<GuestThreads>();
};

}  // namespace rehearse
