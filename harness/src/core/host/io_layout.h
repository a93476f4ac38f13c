// IoLayout: the inputs or outputs of one controller in a tick, as a flat array of numbers with a known layout.
//
// The layout is fixed once the controller's initialize() has run. All code that handles inputs and outputs in bulk
// (hashing, recording, comparing, replaying) uses the arrays; the layout describes each number.
#pragma once

#include <cstdint>
#include <vector>

#include "core/kinds/channel_name.h"

namespace rehearse {

enum class Quantity : std::uint8_t {
  q,             // joint displacement; as output the target [rad] or [m]
  dq,            // [rad/s] or [m/s]
  ddq,           // [rad/s²] or [m/s²]
  u,             // effort [N·m] or [N]
  pose,          // of the link: position [m], then quaternion x, y, z, w
  twist,         // of the link's origin: linear [m/s], then angular [rad/s]
  acceleration,  // of the link's origin: linear [m/s²], then angular [rad/s²]
  wrench,        // on the link: force [N], then torque about the world's origin [N·m]
};

constexpr int width_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::pose: return 7;
    case Quantity::twist:
    case Quantity::acceleration:
    case Quantity::wrench: return 6;
    default: return 1;
  }
}

/// The name in the API: the state variable of a link.
constexpr const char* name_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::q: return "q";
    case Quantity::dq: return "dq";
    case Quantity::ddq: return "ddq";
    case Quantity::u: return "u";
    case Quantity::pose: return "T";
    case Quantity::twist: return "v, w";
    case Quantity::acceleration: return "dv, dw";
    case Quantity::wrench: return "F_ext";
  }
  return "";
}

/// The kind of the channels that record a quantity.
constexpr ChannelKind channel_kind_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::ddq: return ChannelKind::joint_accelerations;
    case Quantity::pose: return ChannelKind::pose;
    case Quantity::twist: return ChannelKind::twist;
    case Quantity::acceleration: return ChannelKind::acceleration;
    case Quantity::wrench: return ChannelKind::wrench;
    default: return ChannelKind::joints;
  }
}

struct IoField {
  int link = 0;    // index into the model's links
  int joint = -1;  // id of the link's joint, or -1
  Quantity quantity = Quantity::q;
  int offset = 0;  // of its first number in the array
};

struct IoLayout {
  std::vector<IoField> fields;  // by link, then by quantity
  int size = 0;                 // number of all elements

  void add(int link, int joint, Quantity quantity) {
    fields.push_back({link, joint, quantity, size});
    size += width_of(quantity);
  }
};

}  // namespace rehearse
