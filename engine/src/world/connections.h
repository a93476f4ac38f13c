// Connections: joints in addition to those of the models' trees. They are the welds and joints of a scenario, the loops
// of a model, and the joints between holders and the links that they hold. Private to the world library.
#pragma once

#include <ode/ode.h>
#include <rehearse/world.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "joint_guide.h"
#include "simulated_body.h"

namespace rehearse {

class Connections {
 public:
  using Bodies = std::vector<std::unique_ptr<SimulatedBody>>;

  /// `bodies` must outlive this. Loops of their models are added to `wanted`.
  Connections(dWorldID world, const Bodies& bodies, std::vector<Connection> wanted);
  /// Errors about connections of two links that never move, or of a kinematic link without shape, which isn't in ODE.
  Diagnostics check() const;

  /// Makes and removes the connections for the step at that time [s], except those of holders.
  void update(double time);
  /// Holders take hold and let go. `touching`: the links that touch in this step.
  void update_holders(const std::vector<LinkPair>& touching);
  const std::vector<std::string>& events() const { return events_; }

  /// The geometry of the connections that exist, for the direct solver.
  std::vector<const JointGuide*> guides() const;

  bool empty() const { return slots_.empty(); }
  /// True if a connection is between the rigid parts to which the links belong.
  bool connect(int body, int link, int other_body, int other_link) const;

  void visit_state(StateVisitor& visitor);
  void after_restore();

 private:
  /// A body of ODE at one moment: position, quaternion and rotation matrix, bit by bit.
  using Motion = std::array<double, 19>;
  struct Slot {
    Connection wanted;
    int holder = -1;  // index of the device of body wanted.body that holds; -1: it is no holder
    dJointID joint = nullptr;
    std::optional<JointGuide> guide;  // of the joint
    // state
    bool connected = false;
    std::uint64_t held = 0;           // of a holder: number of the held link; 0: none
    std::array<Motion, 2> motions{};  // of the bodies when they were connected
  };

  void add_holders();
  void update_holder(Slot& slot, const std::vector<LinkPair>& touching);
  bool find_held(Slot& slot, const std::vector<LinkPair>& touching) const;
  void connect(Slot& slot);
  void close_gap(const Slot& slot) const;
  void make_joints();
  void make_joint(Slot& slot);
  Mount mount(const Slot& slot, bool other) const;
  std::string name_of(int body, int link) const;
  std::uint64_t number_of(int body, int link) const;

  dWorldID world_;
  const Bodies& bodies_;
  std::vector<Slot> slots_;
  std::vector<std::string> events_;  // of the last step
};

}  // namespace rehearse
