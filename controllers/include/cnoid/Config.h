// Export of this API's symbols, and the version of Choreonoid that it corresponds to.
#pragma once

/// Default visibility, whatever -fvisibility a controller is compiled with. Type information must be shared between
/// controller and Rehearse, or dynamic_cast fails across the library boundary.
#define CNOID_GENERAL_EXPORT __attribute__((visibility("default")))

/// The release of Choreonoid with this SimpleController API.
#define CNOID_MAJOR_VERSION 2
#define CNOID_MINOR_VERSION 5
#define CNOID_PATCH_VERSION 0
#define CNOID_VERSION 0x020500
#define CNOID_VERSION_STRING "2.5.0"
