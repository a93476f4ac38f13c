// HostOptions: how a run treats its controllers, whatever the scenario says.
#pragma once

#include <map>
#include <optional>
#include <string>

namespace rehearse {

class ControllerWatch;

struct HostOptions {
  /// Library (a name or a path) to load instead of the scenario's, by controller: NAME or BODY/NAME.
  std::map<std::string, std::string> libraries;
  /// Options to give it instead of the scenario's, by BODY/NAME.
  std::map<std::string, std::string> controller_options;
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
