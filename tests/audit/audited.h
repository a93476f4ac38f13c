// Functions for tests of audits: audit a pendulum with one of the zoo's controllers, and read the command's report.
#pragma once

#include "command.h"

#include <string>

namespace rehearse::test {

class Audited : public Command {
 protected:
  /// 200 ms of a pendulum that is released at 20 degrees.
  /// `more`: further keys of the controller, a line each.
  fs::path scenario(const std::string& library, const std::string& options = "", const std::string& more = "") const {
    return write("zoo.yaml",
                 "rehearse: 1\nduration: 0.2\nbodies:\n  - name: Pendulum\n    model: " +
                     (fixtures / "models/pendulum.urdf").string() +
                     "\n    joints: {hinge: 20 deg}\n    controllers:\n      - name: Zoo\n        library: " +
                     ZOO "/zoo_" + library + ".so\n        options: \"" + options + "\"\n" + more);
  }
};

/// The reason in the report of its first controller that has one, or the empty text.
inline std::string reason_in(const nlohmann::json& report) {
  for (const auto& controller : report["controllers"])
    if (!controller["reason"].is_null()) return controller["reason"];
  return "";
}

}  // namespace rehearse::test
