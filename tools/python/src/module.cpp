// The compiled part of the Python module `rehearse`: package files import it as rehearse._rehearse.
#include <pybind11/pybind11.h>
#include <rehearse/logs.h>

#include "bindings.h"
#include "errors.h"

PYBIND11_MODULE(_rehearse, module) {
  rehearse::read_rosbag2_logs();
  rehearse::python::register_errors();
  rehearse::python::bind_trace(module);
}
