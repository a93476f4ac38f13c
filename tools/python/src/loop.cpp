// The compiled part of rehearse.Tap: module rehearse._loop. It has a library of its own, because a robot's loop needs
// the tap alone.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <rehearse/tap.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace py = pybind11;

namespace rehearse::python {
namespace {

/// Numbers as they are in memory: an array of another type isn't converted, but refused.
using Numbers = py::array_t<double, py::array::c_style>;

/// A tap; the module rehearse._tap closes it.
class Loop {
 public:
  Loop(const std::string& name, const std::string& model, const std::string& controller, double time_step,
       double seconds, unsigned megabytes, bool replace, int spawn, const std::string& output) {
    const auto given = [](const std::string& text) { return text.empty() ? nullptr : text.c_str(); };
    const rehearse_tap_options options{given(model), given(controller), time_step, seconds,
                                       megabytes,    replace ? 1 : 0,   spawn,     given(output)};
    tap_ = rehearse_tap_open(name.c_str(), &options);
    if (!tap_) throw std::runtime_error(rehearse_tap_error());
  }
  ~Loop() { close(); }
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;

  void close() {
    rehearse_tap_close(tap_);
    tap_ = nullptr;
  }
  int joints(const std::string& body, const std::vector<std::string>& names, int quantities, bool are_commands) {
    std::vector<const char*> pointers;
    for (const std::string& name : names) pointers.push_back(name.c_str());
    const auto add = are_commands ? rehearse_tap_commands : rehearse_tap_joints;
    return told(add(tap_, body.c_str(), pointers.data(), pointers.size(), quantities));
  }
  int imu(const std::string& body, const std::string& device) {
    return told(rehearse_tap_imu(tap_, body.c_str(), device.c_str()));
  }
  int device(const std::string& body, const std::string& device, std::size_t count) {
    return told(rehearse_tap_device(tap_, body.c_str(), device.c_str(), count));
  }
  void parameter(const std::string& key, const std::string& value) {
    told(rehearse_tap_parameter(tap_, key.c_str(), value.c_str()));
  }

  void begin(std::int64_t now) { rehearse_tap_begin(tap_, now); }
  void end() { rehearse_tap_end(tap_); }
  bool write(int series, const Numbers& numbers) {
    return rehearse_tap_write(tap_, series, numbers.data(), static_cast<std::size_t>(numbers.size())) == 0;
  }
  bool absent(int series) { return rehearse_tap_absent(tap_, series) == 0; }
  bool variable(const char* name, double value) { return rehearse_tap_variable(tap_, name, value) == 0; }
  bool text(const char* line) { return rehearse_tap_text(tap_, line) == 0; }
  bool image(const char* camera, const char* picture) { return rehearse_tap_image(tap_, camera, picture) == 0; }
  void mark(const char* reason) { rehearse_tap_mark(tap_, reason); }
  std::uint64_t dropped() const { return rehearse_tap_dropped(tap_); }

 private:
  static int told(int result) {
    if (result < 0) throw std::runtime_error(rehearse_tap_error());
    return result;
  }

  rehearse_tap* tap_ = nullptr;
};

}  // namespace
}  // namespace rehearse::python

PYBIND11_MODULE(_loop, module) {
  using rehearse::python::Loop;
  py::class_<Loop>(module, "Loop")
      .def(py::init<const std::string&, const std::string&, const std::string&, double, double, unsigned, bool, int,
                    const std::string&>())
      .def("close", &Loop::close)
      .def("joints", &Loop::joints)
      .def("imu", &Loop::imu)
      .def("device", &Loop::device)
      .def("parameter", &Loop::parameter)
      .def("begin", &Loop::begin)
      .def("end", &Loop::end)
      .def("write", &Loop::write, py::arg("series"), py::arg("numbers").noconvert())
      .def("absent", &Loop::absent)
      .def("variable", &Loop::variable)
      .def("text", &Loop::text)
      .def("image", &Loop::image)
      .def("mark", &Loop::mark)
      .def("dropped", &Loop::dropped);
}
