// ReadBacks: the quantities that a controller reads and a controller of the same body commands.
//
// Choreonoid copies outputs into the body of the simulation, from which inputs are copied. An effort stays there until
// the next output. An external wrench is the sum of the outputs after the step. Accelerations, poses and twists are
// those that were output after the step, else those of the step itself. Displacements and velocities of joints are
// read from the state and output into targets, so neither changes the other.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "io_layout.h"
#include "timing.h"

namespace rehearse {

class ControllerIo;
struct HostedController;
struct Scenario;

class ReadBacks {
 public:
  /// Finds the quantities that running controllers both read and command. Efforts of joints with an actuator or with
  /// errors are left out: their readings are measurements.
  void find(const Scenario& scenario, const std::vector<HostedController>& controllers);
  /// From now on give() passes the values on. Controllers that are fed from a recording or a log read that.
  void begin() { is_on_ = true; }
  /// Before the outputs of a tick that come after the step: those of the tick before are gone.
  void begin_late_outputs();
  /// There is no external wrench until the next output.
  void clear_wrenches();
  /// Takes a number, or the numbers, that a controller commands. Numbers that aren't finite must be left out.
  void take(std::size_t controller, const IoField& field, std::span<const double> values, Timing timing);
  /// Passes the values to the controller's body, in place of the observed ones.
  void give(std::size_t controller, ControllerIo& io) const;

 private:
  struct Value {
    int body = 0;
    int link = 0;
    Quantity quantity = Quantity::u;
    bool is_known = false;
    std::array<double, 7> numbers{};
  };
  std::size_t place_of(int body, int link, Quantity quantity) const;

  bool is_on_ = false;
  std::vector<Value> values_;
  /// By controller: the fields of its inputs, and the places of their values.
  std::vector<std::vector<std::pair<IoField, std::size_t>>> read_;
  std::vector<int> bodies_;  // by controller
};

}  // namespace rehearse
