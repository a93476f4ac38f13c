// What ParentController tells its child, ChildController, beside the body that they share.
#pragma once

#include <cnoid/Referenced>

class TrayState : public cnoid::Referenced {
 public:
  static constexpr const char* name = "TrayState";

  double load = 0.0;         // of the tray and of all that is on it [kg]
  bool has_arrived = false;  // it no longer moves
};
