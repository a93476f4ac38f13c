// A walking pattern for SR1: joint displacements over time, computed from a few parameters.
//
// The feet's places follow from the steps. The zero moment point (ZMP) rests below the standing foot and moves to the
// other one while both stand. The path of the centre of mass that has this ZMP is that of the linear inverted pendulum,
// by its capture point (walking_pattern.cpp has the formulas and their source). The pattern is then corrected until the
// ZMP of the whole body, with the mass and inertia of each link, is the wanted one.
#pragma once

#include <rehearse/model.h>

#include <Eigen/Core>
#include <string>
#include <vector>

namespace rehearse::tool {

/// Lengths [m], times [s].
struct WalkParameters {
  int steps = 16;               // the last one brings the feet side by side
  double step_length = 0.2;     // from foot to foot
  double step_time = 0.8;       // of one step, with the time on both feet
  double double_support = 0.2;  // time on both feet, at the beginning of a step
  double lift = 0.06;           // of the swinging foot
  double waist_height = 0.64;   // above the floor
  double ankle_height = 0.055;  // above the sole
  double zmp_ahead = 0.045;     // of the ankle
  double zmp_inside = 0.01;     // of the ankle, towards the other foot
  double pause = 1.0;           // standing, before the first step and after the last
  double frame_rate = 25.0;     // of the pattern [1/s]
};

struct WalkingPattern {
  std::vector<std::vector<double>> frames;  // by frame, then by joint id [rad]
  double duration = 0.0;                    // [s]
  double distance = 0.0;                    // from the first to the last place of the feet [m]
  double zmp_error = 0.0;                   // largest distance of the whole body's ZMP from the wanted one [m]
};

/// Computes the pattern. `sr1`: with SR1's names of joints. Errors: parameters for which a leg is too short, or that
/// leave no time to swing a foot; joints beyond their limits; a ZMP that the corrections don't bring to the wanted one.
Result<WalkingPattern> walking_pattern(const Model& sr1, const WalkParameters& parameters);

/// The pattern as a motion file (.seq, format version 4). Its head states the parameters.
std::string motion_text(const WalkingPattern& pattern, const WalkParameters& parameters);

}  // namespace rehearse::tool
