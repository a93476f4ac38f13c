// The pose of a link as a matrix, from its LinkReading. Private to the engine.
#pragma once

#include <rehearse/io.h>

#include <Eigen/Geometry>

namespace rehearse {

inline Eigen::Isometry3d pose_of(const LinkReading& link) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = link.rotation.toRotationMatrix();
  pose.translation() = link.position;
  return pose;
}

}  // namespace rehearse
