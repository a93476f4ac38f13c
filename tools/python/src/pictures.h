// Recorded pictures as numpy arrays.
#pragma once

#include <pybind11/numpy.h>
#include <rehearse/trace.h>

#include <cstddef>

namespace rehearse::python {

/// True if the channel's messages are pictures that picture_at() knows.
bool has_pictures(const TraceChannel& channel);

/// The picture of a message: rows, columns, and three bytes (RGB) for a colour, else one number: a byte, 16 bits, or a
/// float, which is a distance [m] in recordings of Rehearse. Throws a Failure if it can't be decoded.
pybind11::array picture_at(const Trace& trace, const TraceChannel& channel, std::size_t index);

}  // namespace rehearse::python
