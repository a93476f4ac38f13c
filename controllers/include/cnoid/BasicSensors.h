// Includes the headers of all sensors that measure numbers.
#pragma once

#include "AccelerationSensor.h"
#include "ForceSensor.h"
#include "Imu.h"
#include "RateGyroSensor.h"
