// HostOptions: how a run treats its controllers, whatever the scenario says.
#pragma once

#include <map>
#include <optional>
#include <string>

namespace rehearse {

class ControllerWatch;

/// A controller as another scenario has it.
struct GivenController {
  std::string library;    // a name or an absolute path
  std::string options;    // its own option string
  bool delay = true;      // commands act one tick late
  bool optional = false;  // the run goes on without it if it refuses to take part
};

struct HostOptions {
  /// Library (a name or a path) to load instead of any other, by controller: NAME or BODY/NAME.
  std::map<std::string, std::string> libraries;
  /// Instead of the scenario's, by BODY/NAME.
  std::map<std::string, GivenController> controllers;
  /// The options of the whole run instead of the scenario's; none: those.
  std::optional<std::string> run_options;
  /// A call into a controller may take so much wall time [s]; then it counts as hung.
  double call_limit = 10.0;
  /// Libraries stay loaded after the run, with what their static objects hold.
  bool keep_libraries = false;
  /// Is told of each call; null: nobody is. Must outlive the run.
  ControllerWatch* watch = nullptr;
};

}  // namespace rehearse
