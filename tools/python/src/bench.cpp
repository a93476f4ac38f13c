// The compiled part of rehearse.ControllerBench: module rehearse._bench. It has a library of its own, because a bench
// needs the simulation's libraries, and recordings don't.
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <rehearse/controller_bench.h>

#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "errors.h"

namespace py = pybind11;

namespace rehearse::python {
namespace {

/// Exceptions name no line of C++: Python adds the line of the caller.
constexpr CallPlace in_python{};

/// The result of `body`; its exceptions are thrown as a Failure.
template <class Body>
decltype(auto) told(Body body) {
  try {
    return body();
  } catch (const std::out_of_range& unknown) {
    throw unknown_name(unknown.what(), "");
  } catch (const std::logic_error& wrong) {
    throw Failure{{error(wrong.what())}};
  } catch (const std::runtime_error& failed) {
    throw Failure{{error(failed.what())}};
  }
}

std::unique_ptr<ControllerBench> make(const std::string& library, const std::string& model, double time_step,
                                      const std::string& options, const std::map<std::string, double>& joints,
                                      const Eigen::Vector3d& position, bool joystick) {
  BenchOptions settings;
  settings.time_step = time_step;
  settings.options = options;
  settings.joints = joints;
  settings.position = position;
  settings.joystick = joystick;
  return told([&] { return std::make_unique<ControllerBench>(library, model, settings, in_python); });
}

Eigen::Vector4d rotation(const BenchLink& link) { return link.rotation.coeffs(); }

void set_rotation(BenchLink& link, const Eigen::Vector4d& xyzw) {
  if (!(xyzw.norm() > 1e-6)) throw Failure{{error("the quaternion is zero, or no number")}};
  link.rotation.coeffs() = xyzw.normalized();
}

void bind_parts(py::module_& module) {
  py::class_<BenchJoint>(module, "BenchJoint")
      .def_readwrite("q", &BenchJoint::q)
      .def_readwrite("dq", &BenchJoint::dq)
      .def_readwrite("ddq", &BenchJoint::ddq)
      .def_readwrite("u", &BenchJoint::u)
      .def_readonly("q_target", &BenchJoint::q_target)
      .def_readonly("dq_target", &BenchJoint::dq_target);
  py::class_<BenchLink>(module, "BenchLink")
      .def_readwrite("position", &BenchLink::position)
      .def_property("rotation", &rotation, &set_rotation)
      .def_readwrite("velocity", &BenchLink::velocity)
      .def_readwrite("angular_velocity", &BenchLink::angular_velocity)
      .def_readwrite("acceleration", &BenchLink::acceleration)
      .def_readwrite("angular_acceleration", &BenchLink::angular_acceleration)
      .def_readonly("force", &BenchLink::force)
      .def_readonly("torque", &BenchLink::torque);
  py::class_<BenchDevice>(module, "BenchDevice")
      .def_readwrite("values", &BenchDevice::values)
      .def_readonly("on", &BenchDevice::on);
}

}  // namespace
}  // namespace rehearse::python

PYBIND11_MODULE(_bench, module) {
  using namespace rehearse::python;
  using rehearse::ControllerBench;
  constexpr auto inside = py::return_value_policy::reference_internal;
  register_errors();
  bind_parts(module);
  py::class_<ControllerBench>(module, "Bench")
      .def(py::init(&make))
      .def(
          "joint",
          [](ControllerBench& bench, const std::string& name) {
            return told([&] { return &bench.joint(name, in_python); });
          },
          inside)
      .def(
          "link",
          [](ControllerBench& bench, const std::string& name) {
            return told([&] { return &bench.link(name, in_python); });
          },
          inside)
      .def(
          "device",
          [](ControllerBench& bench, const std::string& name) {
            return told([&] { return &bench.device(name, in_python); });
          },
          inside)
      .def("set_axis", [](ControllerBench& bench, const std::string& name,
                          double value) { told([&] { bench.axis(name, in_python) = value; }); })
      .def("set_button", [](ControllerBench& bench, const std::string& name,
                            bool pressed) { told([&] { bench.button(name, in_python) = pressed; }); })
      .def("update_links", [](ControllerBench& bench) { told([&] { bench.update_links(); }); })
      .def("tick", [](ControllerBench& bench) { return told([&] { return bench.tick(in_python); }); })
      .def_property_readonly("time", &ControllerBench::time)
      .def_property_readonly("ticks", &ControllerBench::ticks)
      .def("variable", [](const ControllerBench& bench,
                          const std::string& name) { return told([&] { return bench.variable(name, in_python); }); })
      .def_property_readonly("messages", &ControllerBench::messages);
}
