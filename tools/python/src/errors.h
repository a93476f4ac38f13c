// Errors of Rehearse's functions as exceptions of the Python module.
#pragma once

#include <pybind11/pybind11.h>
#include <rehearse/diagnostic.h>

#include <utility>

namespace rehearse::python {

/// Becomes rehearse.Error, with the file, line, column, message and hint of each diagnostic.
struct Failure {
  Diagnostics diagnostics;
  bool is_unknown_name = false;  // becomes rehearse.UnknownName, which is a KeyError too
};

/// The value of the result; its diagnostics are thrown as a Failure.
template <class T>
T value_of(Result<T> result) {
  if (!result) throw Failure{result.errors()};
  return std::move(result).value();
}

inline Failure unknown_name(std::string message, std::string hint) {
  return {{error(std::move(message), std::move(hint))}, true};
}

/// From now on a Failure that leaves a function of the module is raised as its exception.
void register_errors();

}  // namespace rehearse::python
