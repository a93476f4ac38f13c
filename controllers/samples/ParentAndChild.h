// The data that ParentController shares with its child, ChildController, in addition to the body.
#pragma once

#include <cnoid/Referenced>

class TrayState : public cnoid::Referenced {
 public:
  static constexpr const char* name = "TrayState";

  double load = 0.0;         // mass of the tray and of everything on it [kg]
  bool has_arrived = false;  // the arm no longer moves
};
