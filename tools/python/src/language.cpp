// librehearse_python.so: runs controllers in Python. The host of controllers loads it for names such as hold.py:Hold
// (core/host/language_functions.h). In a process that is no Python it starts an interpreter, which never ends.
#include <dlfcn.h>
#include <pybind11/embed.h>
#include <pybind11/pybind11.h>
#include <rehearse/controller.h>

#include <csignal>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "controller_io.h"
#include "core/host/language_functions.h"

namespace py = pybind11;

namespace rehearse::python {
namespace {

/// Variables that numpy and its libraries read when they are loaded. Results must not depend on the processor, nor on
/// the number of threads.
constexpr std::pair<const char*, const char*> pins[] = {
    {"OPENBLAS_NUM_THREADS", "1"},
    {"OMP_NUM_THREADS", "1"},
    {"MKL_NUM_THREADS", "1"},
    {"OPENBLAS_CORETYPE", "NEHALEM"},
    {"NPY_DISABLE_CPU_FEATURES", "AVX F16C FMA3 AVX2 AVX512F AVX512CD AVX512_SKX AVX512_CLX AVX512_CNL AVX512_ICL"},
};

/// Sets the pins for its lifetime.
class Pinned {
 public:
  Pinned() {
    for (const auto& [name, value] : pins) {
      const char* before = std::getenv(name);
      before_.emplace_back(before != nullptr, before ? before : "");
      setenv(name, value, 1);
    }
  }
  ~Pinned() {
    for (std::size_t i = 0; i < before_.size(); ++i)
      if (before_[i].first)
        setenv(pins[i].first, before_[i].second.c_str(), 1);
      else
        unsetenv(pins[i].first);
  }
  Pinned(const Pinned&) = delete;
  Pinned& operator=(const Pinned&) = delete;

 private:
  std::vector<std::pair<bool, std::string>> before_;
};

/// The folder of the package `rehearse` in this build or installation; empty: it isn't there.
std::string package_folder() {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&package_folder), &info) == 0 || !info.dli_fname) return {};
  const std::string own = info.dli_fname;
  const std::string folder = own.substr(0, own.rfind('/'));
  for (const char* place : {PACKAGES_FROM_BUILD, PACKAGES_FROM_INSTALLATION}) {
    const std::string packages = folder + "/" + place;
    if (std::unique_ptr<char, void (*)(void*)> path(realpath((packages + "/rehearse/__init__.py").c_str(), nullptr),
                                                    &std::free);
        path)
      return packages;
  }
  return {};
}

py::module_ own_module() { return py::module_::import("rehearse._controller"); }

/// Starts the interpreter: isolated from the environment and the user's folders, with the hash seed 0. Empty: it runs.
std::string start_interpreter() {
  // Modules of numpy and others find the interpreter's functions among the global symbols.
  dlopen(PYTHON_LIBRARY, RTLD_NOW | RTLD_GLOBAL | RTLD_NOLOAD);
  PyConfig config;
  PyConfig_InitIsolatedConfig(&config);
  config.use_hash_seed = 1;
  config.hash_seed = 0;
  config.write_bytecode = 0;
  config.install_signal_handlers = 0;
  // Python's module `signal` would handle Ctrl-C, which belongs to the program, unless it is ignored when the
  // module is loaded.
  auto* const before = signal(SIGINT, SIG_IGN);
  PyPreConfig texts;
  PyPreConfig_InitIsolatedConfig(&texts);
  texts.utf8_mode = 1;  // whatever the locale
  PyStatus status = Py_PreInitialize(&texts);
  if (!PyStatus_Exception(status)) status = PyConfig_SetBytesString(&config, &config.program_name, PYTHON_PROGRAM);
  if (!PyStatus_Exception(status)) status = Py_InitializeFromConfig(&config);
  PyConfig_Clear(&config);
  if (!PyStatus_Exception(status)) Py_XDECREF(PyImport_ImportModule("_signal"));
  signal(SIGINT, before);
  if (PyStatus_Exception(status)) return status.err_msg ? status.err_msg : "it gave no reason";
  const std::string folder = package_folder();
  if (!folder.empty()) {
    py::list path = py::module_::import("sys").attr("path");
    path.insert(0, folder);
  }
  // On a processor without some of the features that the environment disables, numpy would say so on stdout.
  py::module_::import("warnings")
      .attr("filterwarnings")("ignore", "During parsing environment variable 'NPY_DISABLE_CPU_FEATURES'");
  provide_io_module();
  own_module().attr("print_to_recordings")();
  PyEval_SaveThread();
  return {};
}

/// True while Python code runs. A call that was ended from outside, as one that hangs, leaves it set: the interpreter
/// is in the middle of something then, and must not be entered again.
bool is_inside = false;

/// False also while Python ends, which destroys benches that are left.
bool can_enter() { return !is_inside && Py_IsInitialized() && !_Py_IsFinalizing(); }

class Entered {
 public:
  Entered() : state_(PyGILState_Ensure()) { is_inside = true; }
  ~Entered() {
    is_inside = false;
    PyGILState_Release(state_);
  }
  Entered(const Entered&) = delete;
  Entered& operator=(const Entered&) = delete;

 private:
  PyGILState_STATE state_;
};

/// A controller's object, between create() and destroy().
struct Instance {
  py::object type;
  py::object controller;
  rehearse_io* io = nullptr;
  std::string problem;  // the exception of the constructor
};

/// What load() returned.
struct Loaded {
  py::object type;
};

Loaded* next = nullptr;  // of the next create()

/// Prints the traceback, and states the exception as the failure of the controller.
int report(Instance& instance, py::error_already_set& raised) {
  std::string sentence = raised.what();
  try {
    const py::object value = raised.value();
    if (raised.trace()) PyException_SetTraceback(value.ptr(), raised.trace().ptr());
    sentence = py::str(own_module().attr("sentence")(value));
    const std::string text = py::str(own_module().attr("told")(value));
    if (instance.io) rehearse_print(instance.io, text.c_str());
  } catch (const std::exception&) {
    PyErr_Clear();
  }
  if (!instance.io) {
    instance.problem = sentence;
    return REHEARSE_FAILED;
  }
  return rehearse_set_error(instance.io, sentence.c_str());
}

/// Calls `body`, which calls the controller's method and returns a code.
template <class Body>
int guarded(Instance& instance, Body body) {
  if (is_inside) return rehearse_set_error(instance.io, "an earlier call into Python never returned");
  const Entered entered;
  set_current(instance.io);
  try {
    return body();
  } catch (py::error_already_set& raised) {
    return report(instance, raised);
  }
}

/// REHEARSE_OK for True and None; `otherwise` for any other value that is false.
int code_of(const py::object& result, int otherwise) {
  if (result.is_none()) return REHEARSE_OK;
  const int is_true = PyObject_IsTrue(result.ptr());
  if (is_true < 0) throw py::error_already_set();
  return is_true ? int{REHEARSE_OK} : otherwise;
}

void* create() {
  auto* instance = new Instance;
  if (is_inside || !next) return instance;
  const Entered entered;
  instance->type = next->type;
  try {
    instance->controller = instance->type();
  } catch (py::error_already_set& raised) {
    report(*instance, raised);
  }
  return instance;
}

int initialize(void* self, rehearse_io* io) {
  auto& instance = *static_cast<Instance*>(self);
  instance.io = io;
  if (!instance.problem.empty()) return rehearse_set_error(io, instance.problem.c_str());
  return guarded(instance, [&] {
    const int code = code_of(instance.controller.attr("initialize")(io_object(io)), REHEARSE_FAILED);
    return code < 0 ? rehearse_set_error(io, "its initialize() returned False") : code;
  });
}

int start(void* self) {
  auto& instance = *static_cast<Instance*>(self);
  return guarded(instance, [&] { return code_of(instance.controller.attr("start")(), REHEARSE_FAILED); });
}

int control(void* self) {
  auto& instance = *static_cast<Instance*>(self);
  return guarded(instance, [&] { return code_of(instance.controller.attr("control")(), REHEARSE_FINISHED); });
}

void stop(void* self) {
  auto& instance = *static_cast<Instance*>(self);
  if (!can_enter()) return;
  guarded(instance, [&] {
    instance.controller.attr("stop")();
    return int{REHEARSE_OK};
  });
}

void destroy(void* self) {
  auto* instance = static_cast<Instance*>(self);
  if (!can_enter()) return;  // its objects can't be destroyed
  const Entered entered;
  delete instance;
}

constexpr rehearse_controller_functions functions = {
    REHEARSE_CONTROLLER_ABI, &create, &initialize, &start, &control, &stop, &destroy};

void describe(py::error_already_set& raised, const char* file, LanguageProblem& problem) {
  const py::object value = raised.value();
  if (raised.trace()) PyException_SetTraceback(value.ptr(), raised.trace().ptr());
  const py::tuple place = own_module().attr("place_of")(value);
  problem.message = py::cast<std::string>(own_module().attr("plain")(value));
  problem.file = py::cast<std::string>(place[0]);
  problem.line = py::cast<int>(place[1]);
  if (problem.file.empty()) problem.file = file;
}

void* load(const char* file, const char* entry, LanguageProblem& problem) {
  if (is_inside) {
    problem.message = "an earlier call into Python never returned";
    return nullptr;
  }
  const Pinned pinned;
  if (!Py_IsInitialized()) {
    if (const std::string reason = start_interpreter(); !reason.empty()) {
      problem.message = "Python can't be started: " + reason;
      return nullptr;
    }
  }
  const Entered entered;
  try {
    provide_io_module();
    return new Loaded{own_module().attr("load")(file, entry)};
  } catch (py::error_already_set& raised) {
    describe(raised, file, problem);
  }
  return nullptr;
}

void list_files(const char* file, void (*add)(void*, const char*), void* context) {
  if (is_inside) return add(context, file);
  if (!Py_IsInitialized() && !start_interpreter().empty()) return add(context, file);
  const Entered entered;
  try {
    for (const py::handle path : own_module().attr("files")(file)) add(context, py::cast<std::string>(path).c_str());
  } catch (py::error_already_set&) {
    add(context, file);
  }
}

const rehearse_controller_functions* functions_of(void* loaded) {
  next = static_cast<Loaded*>(loaded);
  return &functions;
}

void unload(void* loaded) {
  if (!can_enter()) return;
  const Entered entered;
  delete static_cast<Loaded*>(loaded);
  own_module().attr("unload")();
}

}  // namespace
}  // namespace rehearse::python

extern "C" __attribute__((visibility("default"))) const rehearse::LanguageFunctions rehearse_language = {
    rehearse::language_functions_version, &rehearse::python::load, &rehearse::python::list_files,
    &rehearse::python::functions_of, &rehearse::python::unload};
