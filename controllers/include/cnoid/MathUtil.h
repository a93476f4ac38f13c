// Conversions between degrees and radians.
#pragma once

#include <cmath>

namespace cnoid {

constexpr double PI = 3.141592653589793238462643383279502884;
constexpr double PI_2 = PI / 2.0;
constexpr double TO_DEGREE = 180.0 / PI;
constexpr double TO_RADIAN = PI / 180.0;

inline double degree(double radians) { return TO_DEGREE * radians; }
inline float degree(float radians) { return static_cast<float>(TO_DEGREE) * radians; }
inline double radian(double degrees) { return TO_RADIAN * degrees; }
inline float radian(float degrees) { return static_cast<float>(TO_RADIAN) * degrees; }
inline double radian(int degrees) { return TO_RADIAN * degrees; }

}  // namespace cnoid
