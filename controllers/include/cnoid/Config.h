// How symbols of this API are exported, and which Choreonoid it speaks like.
#pragma once

/// Default visibility, whatever -fvisibility a controller is compiled with: its classes and ours must agree on type
/// information, or dynamic_cast fails across the boundary.
#define CNOID_GENERAL_EXPORT __attribute__((visibility("default")))

/// The release of Choreonoid whose SimpleController API this is.
#define CNOID_MAJOR_VERSION 2
#define CNOID_MINOR_VERSION 5
#define CNOID_PATCH_VERSION 0
#define CNOID_VERSION 0x020500
#define CNOID_VERSION_STRING "2.5.0"
