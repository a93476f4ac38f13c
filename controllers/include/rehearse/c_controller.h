// For those who host controllers: a controller in C as a cnoid::SimpleController.
#pragma once

#include <cnoid/SimpleController>

#include <stdexcept>
#include <string>

#include "rehearse/controller.h"

namespace rehearse {

/// Thrown by control() of a controller in C that returned a negative code. what() is "returned -1: " and its sentence.
class CNOID_GENERAL_EXPORT ReportedFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  ~ReportedFailure() override;
};

/// The reason why these functions can't be a controller: an unknown version, a needed function that is null. Empty:
/// they can.
CNOID_GENERAL_EXPORT std::string problem_of(const rehearse_controller_functions& functions);

/// A new controller that calls these functions, which must outlive it and have no problem_of(). Calls create().
CNOID_GENERAL_EXPORT cnoid::SimpleController* make_c_controller(const rehearse_controller_functions& functions);

}  // namespace rehearse
