#include "pictures.h"

#include <rehearse/messages.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "errors.h"
#include "picture/picture.h"

namespace py = pybind11;

namespace rehearse::python {
namespace {

/// The layout of an uncompressed picture.
struct Layout {
  const char* encoding;  // of sensor_msgs/msg/Image
  const char* type;      // of numpy
  std::size_t bytes;     // of a pixel in the message
  std::size_t channels;  // in the array
  bool reversed;         // blue comes first
};
constexpr Layout layouts[] = {
    {"rgb8", "u1", 3, 3, false},   {"rgba8", "u1", 4, 3, false}, {"bgr8", "u1", 3, 3, true},
    {"bgra8", "u1", 4, 3, true},   {"mono8", "u1", 1, 1, false}, {"8UC1", "u1", 1, 1, false},
    {"mono16", "u2", 2, 1, false}, {"16UC1", "u2", 2, 1, false}, {"32FC1", "f4", 4, 1, false},
};

[[noreturn]] void fail(const Trace& trace, const TraceChannel& channel, std::size_t index, const std::string& reason) {
  throw Failure{{error_in(trace.file(), "picture " + std::to_string(index) + " of " + channel.topic + " " + reason)}};
}

py::array colors(const Image& image) {
  py::array_t<std::uint8_t> array({image.height, image.width, 3});
  std::ranges::copy(image.pixels, array.mutable_data());
  return array;
}

py::array uncompressed(const msg::Image& image, const Layout& layout) {
  std::vector<py::ssize_t> shape{image.height, image.width};
  if (layout.channels == 3) shape.push_back(3);
  py::array array(py::dtype((image.is_bigendian ? ">" : "<") + std::string(layout.type)), shape);
  auto* to = static_cast<std::uint8_t*>(array.mutable_data());
  const std::size_t kept = layout.channels == 3 ? 3 : layout.bytes;
  for (std::uint32_t row = 0; row < image.height; ++row)
    for (std::uint32_t column = 0; column < image.width; ++column, to += kept) {
      std::memcpy(to, image.data.data() + std::size_t{row} * image.step + column * layout.bytes, kept);
      if (layout.reversed) std::swap(to[0], to[2]);
    }
  return array;
}

}  // namespace

bool has_pictures(const TraceChannel& channel) {
  return (channel.type == msg::Image::type_name || channel.type == msg::CompressedImage::type_name) &&
         channel.messages() == channel.locations.size() && channel.encoding == "cdr";
}

py::array picture_at(const Trace& trace, const TraceChannel& channel, std::size_t index) {
  const std::vector<std::byte> bytes = value_of(trace.payload(channel, index));
  CdrReader reader(bytes);
  if (channel.type == msg::CompressedImage::type_name) {
    msg::CompressedImage compressed;
    if (!msg::decode(reader, compressed)) fail(trace, channel, index, "can't be decoded");
    const auto image = decode_picture(compressed.data);
    if (!image) fail(trace, channel, index, "can't be decoded: " + image.errors()[0].message);
    return colors(*image);
  }
  msg::Image image;
  if (!msg::decode(reader, image)) fail(trace, channel, index, "can't be decoded");
  const auto* layout = std::ranges::find(layouts, image.encoding, [](const Layout& one) { return one.encoding; });
  if (layout == std::end(layouts))
    fail(trace, channel, index, "has the encoding '" + image.encoding + "', which isn't known");
  const std::size_t row = image.width * layout->bytes;
  if (image.step < row || (image.height > 0 && image.data.size() < std::size_t{image.step} * (image.height - 1) + row))
    fail(trace, channel, index, "has fewer bytes than its size needs");
  return uncompressed(image, *layout);
}

}  // namespace rehearse::python
