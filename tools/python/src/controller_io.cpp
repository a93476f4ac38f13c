#include "controller_io.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <rehearse_variable.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "errors.h"

namespace py = pybind11;

namespace rehearse::python {
namespace {

struct Io {
  rehearse_io* io;
};

rehearse_io* current = nullptr;

void write(const std::string& text) {
  if (current)
    rehearse_print(current, text.c_str());
  else
    std::fwrite(text.data(), 1, text.size(), stdout);
}

/// A handle of rehearse/controller.h and the view that it belongs to.
struct Part {
  rehearse_io* io;
  int handle;
};
struct Joint : Part {};
struct RobotLink : Part {};
struct RobotDevice : Part {};

[[noreturn]] void fail(const rehearse_io* io) { throw Failure{{error(rehearse_error(io))}}; }

/// The result of a function; a code of failure is thrown with its sentence.
int checked(const rehearse_io* io, int result) {
  if (result < 0) fail(io);
  return result;
}

struct QuantityName {
  const char* name;
  int quantity;
};
constexpr QuantityName quantity_names[] = {
    {"q", REHEARSE_Q},
    {"dq", REHEARSE_DQ},
    {"ddq", REHEARSE_DDQ},
    {"u", REHEARSE_U},
    {"pose", REHEARSE_POSE},
    {"twist", REHEARSE_TWIST},
    {"acceleration", REHEARSE_ACCELERATION},
    {"wrench", REHEARSE_WRENCH},
};

int quantities_of(const py::args& names) {
  int all = 0;
  for (const py::handle name : names) {
    const std::string text = py::str(name);
    const auto* found =
        std::ranges::find(quantity_names, text, [](const QuantityName& one) { return std::string(one.name); });
    if (found == std::end(quantity_names))
      throw Failure{{error("there is no quantity '" + text + "'",
                           "of a joint q, dq, ddq, u; of a link pose, twist, acceleration, wrench")}};
    all |= found->quantity;
  }
  if (all == 0) throw Failure{{error("no quantity is named", "as read(\"q\", \"dq\")")}};
  return all;
}

template <class Kind>
void bind_quantities(py::class_<Kind>& kind) {
  kind.def(
      "read",
      [](const Kind& part, const py::args& names) {
        checked(part.io, rehearse_read(part.io, part.handle, quantities_of(names)));
      },
      "The quantities are refreshed before each control(). In initialize() only.");
  kind.def(
      "command",
      [](const Kind& part, const py::args& names) {
        checked(part.io, rehearse_command(part.io, part.handle, quantities_of(names)));
      },
      "The quantities are sent after each control(); the last call counts. In initialize() only.");
}

template <int quantity>
double get(const Joint& joint) {
  return rehearse_get(joint.io, joint.handle, quantity);
}

template <int quantity>
void set(const Joint& joint, double value) {
  checked(joint.io, rehearse_set(joint.io, joint.handle, quantity, value));
}

template <int quantity>
std::pair<double, double> limits(const Joint& joint) {
  std::pair<double, double> pair;
  checked(joint.io, rehearse_limits(joint.io, joint.handle, quantity, &pair.first, &pair.second));
  return pair;
}

void bind_joint(py::module_& module) {
  py::class_<Joint> joint(module, "Joint", "A joint of the robot, from io.joint(NAME) or io.joints.");
  bind_quantities(joint);
  joint.def_property_readonly("name", [](const Joint& one) { return rehearse_joint_name(one.io, one.handle); })
      .def_property_readonly("q", &get<REHEARSE_Q>,
                             "Displacement [rad or m]; before the first control() the initial one.")
      .def_property_readonly("dq", &get<REHEARSE_DQ>, "Velocity [rad/s or m/s].")
      .def_property_readonly("ddq", &get<REHEARSE_DDQ>, "Acceleration [rad/s² or m/s²].")
      .def_property("u", &get<REHEARSE_U>, &set<REHEARSE_U>, "Torque or force [N·m or N]: read, or the command.")
      .def_property("q_target", nullptr, &set<REHEARSE_Q>, "The commanded displacement [rad or m].")
      .def_property("dq_target", nullptr, &set<REHEARSE_DQ>, "The commanded velocity [rad/s or m/s].")
      .def_property_readonly("q_limits", &limits<REHEARSE_Q>, "(lower, upper) [rad or m]; infinite without a limit.")
      .def_property_readonly("dq_limits", &limits<REHEARSE_DQ>, "(lower, upper) [rad/s or m/s].")
      .def_property_readonly("u_limits", &limits<REHEARSE_U>, "(lower, upper) [N·m or N].")
      .def("__repr__",
           [](const Joint& one) { return "<Joint " + std::string(rehearse_joint_name(one.io, one.handle)) + ">"; });
}

template <int quantity, int size>
py::array_t<double> numbers(const RobotLink& link) {
  py::array_t<double> array(size);
  checked(link.io, rehearse_get_numbers(link.io, link.handle, quantity, array.mutable_data(), size));
  return array;
}

template <int quantity>
void set_numbers(const RobotLink& link, const std::vector<double>& values) {
  checked(link.io,
          rehearse_set_numbers(link.io, link.handle, quantity, values.data(), static_cast<int>(values.size())));
}

void bind_link(py::module_& module) {
  py::class_<RobotLink> link(module, "Link", "A link of the robot, from io.link(NAME) or io.links.");
  bind_quantities(link);
  link.def_property_readonly("name", [](const RobotLink& one) { return rehearse_link_name(one.io, one.handle); })
      .def_property("pose", &numbers<REHEARSE_POSE, 7>, &set_numbers<REHEARSE_POSE>,
                    "Seven numbers in the world: x y z [m], quaternion x y z w.")
      .def_property("twist", &numbers<REHEARSE_TWIST, 6>, &set_numbers<REHEARSE_TWIST>,
                    "Six numbers, world axes: velocity of the origin [m/s], angular velocity [rad/s].")
      .def_property_readonly("acceleration", &numbers<REHEARSE_ACCELERATION, 6>,
                             "Six numbers, world axes: of the origin [m/s²], angular [rad/s²].")
      .def_property("wrench", &numbers<REHEARSE_WRENCH, 6>, &set_numbers<REHEARSE_WRENCH>,
                    "Six numbers, a command: external force [N], torque about the world's origin [N·m].")
      .def("__repr__",
           [](const RobotLink& one) { return "<Link " + std::string(rehearse_link_name(one.io, one.handle)) + ">"; });
}

py::array_t<double> device_numbers(const RobotDevice& device) {
  const int count = checked(device.io, rehearse_device_numbers(device.io, device.handle, nullptr, 0));
  py::array_t<double> array(count);
  checked(device.io, rehearse_device_numbers(device.io, device.handle, array.mutable_data(), count));
  return array;
}

/// A copy: the memory of the host changes with the next control(). None: there is no measurement yet.
template <class Number>
py::object measured(const RobotDevice& device, const Number* (*measure)(rehearse_io*, int, int*)) {
  int shape[3] = {0, 0, 0};
  const Number* first = measure(device.io, device.handle, shape);
  if (!first) return py::none();
  return py::array_t<Number>({shape[0], shape[1], shape[2]}, first);
}

void bind_device(py::module_& module) {
  py::class_<RobotDevice>(module, "Device", "A sensor, camera or light, from io.device(NAME) or io.devices.")
      .def(
          "read", [](const RobotDevice& one) { checked(one.io, rehearse_read_device(one.io, one.handle)); },
          "It is refreshed before a control() whenever it has measured. In initialize() only.")
      .def_property_readonly("name", [](const RobotDevice& one) { return rehearse_device_name(one.io, one.handle); })
      .def_property_readonly(
          "type", [](const RobotDevice& one) { return rehearse_device_type(one.io, one.handle); },
          "As \"ForceSensor\".")
      .def_property(
          "numbers", &device_numbers,
          [](const RobotDevice& one, const std::vector<double>& values) {
            checked(one.io,
                    rehearse_set_device_numbers(one.io, one.handle, values.data(), static_cast<int>(values.size())));
          },
          "The numbers that are recorded, float64: force [N] and torque [N·m] of a force sensor, distances [m] of a "
          "range "
          "sensor. They can be set for devices with settings, as lights.")
      .def_property_readonly(
          "image", [](const RobotDevice& one) { return measured<unsigned char>(one, &rehearse_image); },
          "The last picture: rows, columns, bytes of a pixel; None before the first.")
      .def_property_readonly(
          "points", [](const RobotDevice& one) { return measured<float>(one, &rehearse_points); },
          "The last points of a range camera in its frame [m]: rows, columns, 3; None before the first.")
      .def("__repr__", [](const RobotDevice& one) {
        return "<Device " + std::string(rehearse_device_name(one.io, one.handle)) + ">";
      });
}

template <class Kind>
std::vector<Kind> listed(rehearse_io* io, int count, int (*handle_of)(rehearse_io*, int)) {
  std::vector<Kind> all;
  for (int index = 0; index < checked(io, count); ++index)
    if (const int handle = handle_of ? handle_of(io, index) : index; handle >= 0) all.push_back({{io, handle}});
  return all;
}

template <class Kind>
Kind named(rehearse_io* io, int handle) {
  if (handle < 0) throw Failure{{error(rehearse_error(io))}, handle == REHEARSE_NOT_FOUND};
  return {{io, handle}};
}

void bind_io(py::module_& module) {
  py::class_<Io>(module, "IO", "A controller's view of its robot, from initialize() on.")
      .def_property_readonly(
          "time_step", [](const Io& self) { return rehearse_time_step(self.io); }, "[s]")
      .def_property_readonly(
          "time", [](const Io& self) { return rehearse_time(self.io); }, "Since the start of the run [s].")
      .def_property_readonly(
          "name", [](const Io& self) { return rehearse_name(self.io); }, "In the scenario.")
      .def_property_readonly(
          "options", [](const Io& self) { return rehearse_options(self.io); },
          "The options of the run, a space, and those of this controller.")
      .def(
          "set_no_delay", [](const Io& self, bool on) { checked(self.io, rehearse_set_no_delay(self.io, on)); },
          py::arg("on") = true,
          "A command acts in the step of its control(), not one step later. In initialize() only.")
      .def(
          "print", [](const Io& self, const std::string& text) { rehearse_print(self.io, text.c_str()); },
          py::arg("text"), "Text for people; it is recorded, as that of print() is.")
      .def(
          "variable", [](const Io&, const char* name, double value) { rehearse_variable(name, value); },
          py::arg("name"), py::arg("value"),
          "Records a number in this tick, as the series BODY/CONTROLLER/variable/NAME.")
      .def(
          "joint",
          [](const Io& self, const char* name) { return named<Joint>(self.io, rehearse_joint(self.io, name)); },
          py::arg("name"), "The joint of this name. UnknownName lists the others.")
      .def_property_readonly(
          "joints",
          [](const Io& self) { return listed<Joint>(self.io, rehearse_joint_count(self.io), &rehearse_joint_of_id); },
          "By their ids.")
      .def(
          "link",
          [](const Io& self, const char* name) { return named<RobotLink>(self.io, rehearse_link(self.io, name)); },
          py::arg("name"), "The link of this name. UnknownName lists the others.")
      .def_property_readonly(
          "links", [](const Io& self) { return listed<RobotLink>(self.io, rehearse_link_count(self.io), nullptr); },
          "The root first.")
      .def(
          "device",
          [](const Io& self, const char* name) { return named<RobotDevice>(self.io, rehearse_device(self.io, name)); },
          py::arg("name"), "The device of this name. UnknownName lists the others.")
      .def_property_readonly(
          "devices",
          [](const Io& self) { return listed<RobotDevice>(self.io, rehearse_device_count(self.io), nullptr); },
          "By their numbers.");
}

}  // namespace

void provide_io_module() {
  py::dict modules = py::module_::import("sys").attr("modules");
  constexpr const char* name = "rehearse._io";
  if (modules.contains(name)) return;
  static py::module_::module_def definition;
  py::module_ module = py::module_::create_extension_module(name, "A controller's view of its robot.", &definition);
  register_errors();
  bind_joint(module);
  bind_link(module);
  bind_device(module);
  bind_io(module);
  module.def("write", &write, "Text of print(), for the recording of the controller that is called.");
  modules[name] = module;
}

void set_current(rehearse_io* io) { current = io; }

py::object io_object(rehearse_io* io) { return py::cast(Io{io}); }

}  // namespace rehearse::python
