// rehearse._rehearse.Trace: series of a recording as numpy arrays that share its memory.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/trace.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bindings.h"
#include "core/kinds/channel_name.h"
#include "core/trace/filter.h"
#include "errors.h"
#include "pictures.h"

namespace py = pybind11;

namespace rehearse::python {
namespace {

using Held = std::shared_ptr<Trace>;

struct FoundSeries {
  const TraceChannel& channel;
  std::size_t column;
};

FoundSeries find(const Trace& trace, const std::string& name) {
  const auto place = trace.find_series(name);
  if (!place) {
    const std::string nearest = trace.nearest_series(name);
    throw unknown_name(trace.file() + " has no series '" + name + "'",
                       nearest.empty() ? "it has no series at all" : "the nearest are " + nearest);
  }
  return {trace.channels()[place->channel], place->column};
}

const TraceChannel& channel_of(const Trace& trace, const std::string& topic) {
  const TraceChannel* channel = trace.find_channel(topic);
  if (!channel) throw unknown_name(trace.file() + " has no channel '" + topic + "'", "");
  return *channel;
}

const char* type_of(CellKind kind) {
  switch (kind) {
    case CellKind::floating: return "f8";
    case CellKind::signed_integer: return "i8";
    case CellKind::unsigned_integer:
    case CellKind::boolean: return "u8";
  }
  return "f8";
}

/// A view of memory that `owner` keeps; it can't be written.
py::array view(const char* type, std::size_t rows, std::size_t stride, const std::uint64_t* first, py::handle owner) {
  py::array array(py::dtype(type), {static_cast<py::ssize_t>(rows)},
                  {static_cast<py::ssize_t>(stride * sizeof(std::uint64_t))}, first, owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

py::array values(const py::object& self, const std::string& name) {
  const auto [channel, column] = find(*self.cast<Held>(), name);
  const CellKind kind = channel.columns[column].kind;
  py::array cells = view(type_of(kind), channel.rows(), channel.columns.size(), channel.cells.data() + column, self);
  if (kind != CellKind::boolean) return cells;
  return cells.attr("astype")("bool");
}

py::array stamps(const py::object& self, const TraceChannel& channel) {
  return view("u8", channel.messages(), 1, channel.times.data(), self);
}

py::dict described(const msg::Event& event) {
  using namespace py::literals;
  return py::dict("time"_a = event.stamp.sec + event.stamp.nanosec * 1e-9, "tick"_a = event.tick,
                  "severity"_a = event.severity, "source"_a = event.source, "text"_a = event.text);
}

py::dict described(const msg::ContactChange& change) {
  using namespace py::literals;
  return py::dict("time"_a = change.stamp.sec + change.stamp.nanosec * 1e-9, "tick"_a = change.tick,
                  "link"_a = change.link, "other"_a = change.other, "begins"_a = change.begins);
}

template <class Messages>
py::list listed(const Messages& messages) {
  py::list all;
  for (const auto& message : messages) all.append(described(message));
  return all;
}

py::dict metadata(const Trace& trace) {
  py::dict all;
  for (const mcap::Metadata& record : trace.metadata()) {
    py::dict entries;
    for (const auto& [name, value] : record.values) entries[py::str(name)] = value;
    all[py::str(record.name)] = entries;
  }
  return all;
}

py::dict attachments(const Trace& trace) {
  py::dict all;
  for (const mcap::Attachment& attachment : trace.attachments())
    all[py::str(attachment.name)] =
        py::bytes(reinterpret_cast<const char*>(attachment.data.data()), attachment.data.size());
  return all;
}

Held load(const std::filesystem::path& file, bool tolerate) {
  const py::gil_scoped_release others_run;
  return std::make_shared<Trace>(
      value_of(Trace::load(file, tolerate ? Trace::Damage::tolerate : Trace::Damage::refuse)));
}

/// Writes the channels of these topics into another file; the chunks of others aren't decompressed.
void select(const std::filesystem::path& file, const std::filesystem::path& target,
            const std::vector<std::string>& topics) {
  const py::gil_scoped_release others_run;
  mcap::FilterOptions options;
  options.selection.topics = topics;
  options.compression = mcap::Compression::none;
  value_of(mcap::filter(file, target, options));
}

}  // namespace

void bind_trace(py::module_& module) {
  module.def("select", &select);
  py::class_<Trace, Held>(module, "Trace")
      .def(py::init(&load), py::arg("file"), py::arg("tolerate"))
      .def_property_readonly("file", &Trace::file)
      .def_property_readonly("duration", &Trace::duration)
      .def_property_readonly("ticks", &Trace::ticks)
      .def_property_readonly("damage",
                             [](const Trace& trace) {
                               std::vector<std::string> lines;
                               for (const Diagnostic& found : trace.damage()) lines.push_back(to_string(found));
                               return lines;
                             })
      .def_property_readonly("names",
                             [](const Trace& trace) {
                               std::vector<std::string> names;
                               for (const auto& [name, place] : trace.series()) names.push_back(name);
                               return names;
                             })
      .def("has", [](const Trace& trace, const std::string& name) { return trace.find_series(name).has_value(); })
      .def("values", [](const py::object& self, const std::string& name) { return values(self, name); })
      .def("stamps", [](const py::object& self,
                        const std::string& name) { return stamps(self, find(*self.cast<Held>(), name).channel); })
      .def("channel_stamps",
           [](const py::object& self, const std::string& topic) {
             return stamps(self, channel_of(*self.cast<Held>(), topic));
           })
      .def("unit",
           [](const Trace& trace, const std::string& name) {
             const auto [channel, column] = find(trace, name);
             return unit_of(channel.metadata, channel.columns[column].element);
           })
      .def_property_readonly("topics",
                             [](const Trace& trace) {
                               std::vector<std::pair<std::string, std::string>> all;
                               for (const TraceChannel& channel : trace.channels())
                                 all.emplace_back(channel.topic, channel.type);
                               return all;
                             })
      .def_property_readonly("picture_topics",
                             [](const Trace& trace) {
                               std::vector<std::string> topics;
                               for (const TraceChannel& channel : trace.channels())
                                 if (has_pictures(channel)) topics.push_back(channel.topic);
                               return topics;
                             })
      .def("picture", [](const Trace& trace, const std::string& topic,
                         std::size_t index) { return picture_at(trace, channel_of(trace, topic), index); })
      .def_property_readonly("events", [](const Trace& trace) { return listed(trace.events()); })
      .def_property_readonly("contacts", [](const Trace& trace) { return listed(trace.contact_changes()); })
      .def_property_readonly("metadata", &metadata)
      .def_property_readonly("attachments", &attachments);
}

}  // namespace rehearse::python
