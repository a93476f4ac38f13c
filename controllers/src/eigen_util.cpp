#include <cnoid/EigenUtil>

#include "numbers.h"

namespace cnoid {

namespace {

constexpr double nearlySingular = 1.0e-6;  // [rad] from straight up or down, where roll and yaw turn about one axis

/// `angle` plus the whole turns that bring it nearest to `reference`.
double nearestTurn(double angle, double reference) {
  return angle + 2.0 * PI * std::round((reference - angle) / (2.0 * PI));
}

template <class Vector>
Vector nearestTurns(const Vector& angles, const Vector& references) {
  return Vector(nearestTurn(angles[0], references[0]), nearestTurn(angles[1], references[1]),
                nearestTurn(angles[2], references[2]));
}

template <class Vector>
std::string join(const Vector& v) {
  std::string text = printNumber(v[0]);
  for (Eigen::Index i = 1; i < v.size(); ++i) text += " " + printNumber(v[i]);
  return text;
}

template <class Vector>
bool parse(const std::string& text, Vector& v) {
  const std::string space = " \t\r\n";
  std::size_t place = text.find_first_not_of(space);
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    if (place == std::string::npos) return false;
    const std::size_t end = std::min(text.find_first_of(space + ",", place), text.size());
    if (!parseNumber(std::string_view(text).substr(place, end - place), v[i])) return false;
    place = text.find_first_not_of(space, end);
    const bool isLast = i + 1 == v.size();
    if (!isLast && place != std::string::npos && text[place] == ',') place = text.find_first_not_of(space, place + 1);
  }
  return place == std::string::npos;
}

template <class Matrix>
void makeOrthonormal(Matrix&& R) {
  const Vector3 x = R.col(0).normalized();
  const Vector3 z = x.cross(Vector3(R.col(1))).normalized();
  R.col(0) = x;
  R.col(1) = z.cross(x);
  R.col(2) = z;
}

}  // namespace

Matrix3 rotFromRpy(double roll, double pitch, double yaw) {
  const double cr = std::cos(roll), sr = std::sin(roll);
  const double cp = std::cos(pitch), sp = std::sin(pitch);
  const double cy = std::cos(yaw), sy = std::sin(yaw);
  Matrix3 R;
  R << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,   //
      -sp, cp * sr, cp * cr;
  return R;
}

Vector3 rpyFromRot(const Matrix3& R) {
  const double pitch = std::atan2(-R(2, 0), std::hypot(R(2, 1), R(2, 2)));
  if (std::abs(pitch) > PI_2 - nearlySingular) return Vector3(std::atan2(-R(1, 2), R(1, 1)), pitch, 0.0);
  return Vector3(std::atan2(R(2, 1), R(2, 2)), pitch, std::atan2(R(1, 0), R(0, 0)));
}

Vector3 rpyFromRot(const Matrix3& R, const Vector3& previous) {
  const Vector3 direct = rpyFromRot(R);
  if (std::abs(direct.y()) > PI_2 - nearlySingular) {
    // Only roll - yaw (looking up) or roll + yaw (looking down) is determined: share the change between the two.
    const double sign = direct.y() > 0.0 ? -1.0 : 1.0;
    const double combined = nearestTurn(direct.x(), previous.x() + sign * previous.z());
    const double change = (combined - (previous.x() + sign * previous.z())) / 2.0;
    return Vector3(previous.x() + change, nearestTurn(direct.y(), previous.y()), previous.z() + sign * change);
  }
  // The same rotation the other way round: over the top.
  const Vector3 over(direct.x() + PI, PI - direct.y(), direct.z() + PI);
  const Vector3 nearDirect = nearestTurns(direct, previous);
  const Vector3 nearOver = nearestTurns(over, previous);
  return std::abs(nearDirect.y() - previous.y()) <= std::abs(nearOver.y() - previous.y()) ? nearDirect : nearOver;
}

Vector3 omegaFromRot(const Matrix3& R) {
  const AngleAxis rotation(R);  // through a quaternion, so exact near pi too
  return rotation.angle() * rotation.axis();
}

Matrix3 hat(const Vector3& x) {
  Matrix3 M;
  M << 0.0, -x.z(), x.y(),  //
      x.z(), 0.0, -x.x(),   //
      -x.y(), x.x(), 0.0;
  return M;
}

std::string str(const Vector2& v) { return join(v); }
std::string str(const Vector3& v) { return join(v); }
std::string str(const Vector3f& v) { return join(v); }
std::string str(const AngleAxis& a) { return join(a.axis()) + " " + printNumber(a.angle()); }

bool toVector3(const std::string& text, Vector3& v) { return parse(text, v); }
bool toVector3(const std::string& text, Vector3f& v) { return parse(text, v); }
bool toVector6(const std::string& text, Vector6& v) { return parse(text, v); }

void normalizeRotation(Matrix3& R) { makeOrthonormal(R); }
void normalizeRotation(Affine3& T) { makeOrthonormal(T.linear()); }
void normalizeRotation(Isometry3& T) { makeOrthonormal(T.linear()); }

}  // namespace cnoid
