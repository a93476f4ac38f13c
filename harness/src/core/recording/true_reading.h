// TrueReading: the values of a sensor without its errors, beside which the controllers' reading is recorded.
#pragma once

#include <vector>

namespace rehearse {

struct TrueReading {
  int body = 0;                // index into Scenario::bodies
  int device = 0;              // index into its model's devices
  std::vector<double> values;  // as DeviceReading::values
};

}  // namespace rehearse
