// The controller's view of its robot (rehearse/controller.h) as Python objects: module rehearse._io.
#pragma once

#include <pybind11/pybind11.h>
#include <rehearse/controller.h>

namespace rehearse::python {

/// Makes the module, if it isn't there, and puts it among the loaded ones.
void provide_io_module();

/// print() and rehearse._io.write() are for this controller from now on; null: for the process's own output.
void set_current(rehearse_io* io);

/// The object that initialize() of a controller gets.
pybind11::object io_object(rehearse_io* io);

}  // namespace rehearse::python
