#include "errors.h"

#include <exception>
#include <string>

namespace py = pybind11;

namespace rehearse::python {

void register_errors() {
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Failure& failure) {
      py::list diagnostics;
      for (const Diagnostic& found : failure.diagnostics)
        diagnostics.append(py::make_tuple(std::string(to_string(found.severity)), found.file, found.line, found.column,
                                          found.message, found.hint));
      const py::object errors = py::module_::import("rehearse._errors");
      const py::object type = errors.attr(failure.is_unknown_name ? "UnknownName" : "Error");
      PyErr_SetObject(type.ptr(), type.attr("of")(diagnostics).ptr());
    }
  });
}

}  // namespace rehearse::python
