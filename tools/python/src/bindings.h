// The parts of the compiled module.
#pragma once

#include <pybind11/pybind11.h>

namespace rehearse::python {

void bind_trace(pybind11::module_& module);

}  // namespace rehearse::python
