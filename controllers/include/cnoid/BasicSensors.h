// The sensors that measure numbers rather than pictures.
#pragma once

#include "AccelerationSensor.h"
#include "ForceSensor.h"
#include "Imu.h"
#include "RateGyroSensor.h"
