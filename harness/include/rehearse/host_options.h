// HostOptions: options for the controllers of a run, independent of the scenario.
#pragma once

#include <map>
#include <optional>
#include <string>

namespace rehearse {

class ControllerWatch;

/// A controller from a different scenario.
struct GivenController {
  std::string library;    // a name or an absolute path
  std::string options;    // its own option string
  bool delay = true;      // commands act one tick late
  bool optional = false;  // the run continues without it if it refuses to take part
};

/// The controllers of a run, and how they are called.
struct HostOptions {
  /// Library (a name or a path) to load instead of any other, by controller: NAME or BODY/NAME.
  std::map<std::string, std::string> libraries;
  /// Controllers that replace those of the scenario, by BODY/NAME.
  std::map<std::string, GivenController> controllers;
  /// The options of the whole run instead of the scenario's; none: the scenario's.
  std::optional<std::string> run_options;
  /// Limit of the wall time of a call into a controller [s]; a longer call counts as hung.
  double call_limit = 10.0;
  /// Libraries and the contents of their static objects stay loaded after the run.
  bool keep_libraries = false;
  /// Is notified of each call; null: not. Must outlive the run.
  ControllerWatch* watch = nullptr;
};

}  // namespace rehearse
