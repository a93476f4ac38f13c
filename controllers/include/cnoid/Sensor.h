// Former name of BasicSensors.h.
#pragma once

#include "BasicSensors.h"
