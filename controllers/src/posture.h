// The displacements and poses of a body, to be restored if a search for a posture fails.
#pragma once

#include <cnoid/Body>

#include <cstddef>
#include <vector>

namespace cnoid {

class Posture {
 public:
  explicit Posture(const Body& body) {
    for (const auto& link : body.links()) {
      displacements_.push_back(link->q());
      poses_.push_back(link->T());
    }
  }

  void restore(Body& body) const {
    for (int i = 0; i < body.numLinks(); ++i) {
      body.link(i)->q() = displacements_[static_cast<std::size_t>(i)];
      body.link(i)->T() = poses_[static_cast<std::size_t>(i)];
    }
  }

 private:
  std::vector<double> displacements_;
  std::vector<Isometry3, Eigen::aligned_allocator<Isometry3>> poses_;
};

}  // namespace cnoid
