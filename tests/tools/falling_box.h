// A scenario for campaigns: a box that falls, whose height and mass vary.
#pragma once

#include <string>

namespace rehearse::test {

/// `expectation`: of the height of the box [m], as "above: 0.3". `highest`: of its heights, from 0.25 m on.
inline std::string falling_box(const std::string& duration, const std::string& expectation,
                               const std::string& highest) {
  return "rehearse: 1\nduration: " + duration + R"(
bodies:
  - name: Floor
    box: {size: [2, 2, 0.2]}
    fixed: true
    position: [0, 0, -0.1]
  - name: Box
    box: {size: [0.2, 0.2, 0.2]}
    mass: 2    # [kg]
    position: [0, 0, 0.5]
expect:
  - {channel: Box/Box/position/z, )" +
         expectation + R"(}
vary:
  height: {path: "bodies.Box.position[2]", uniform: [0.25, )" +
         highest + R"(]}
  mass: {path: bodies.Box.mass, log_uniform: [0.5, 8]}
)";
}

}  // namespace rehearse::test
