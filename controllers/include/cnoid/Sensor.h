// The old name of BasicSensors.
#pragma once

#include "BasicSensors.h"
