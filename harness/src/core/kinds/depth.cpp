// The depths that a RangeCamera measures.
#include <cstring>
#include <memory>

#include "kind.h"

namespace rehearse {
namespace {

constexpr ElementGroup depth_groups[] = {{"", "m"}};
constexpr const char* depth_encoding = "32FC1";

constexpr LogInput depth_input{.content = LogInput::Content::depth,
                               .key = "cameras",
                               .devices = "cameras that measure depth",
                               .messages = "an Image"};
constexpr DeviceMeasurement depth_measurement{
    .log = depth_input,
    .is_of = [](const Device& device) { return std::get<Camera>(device.kind).depth; },
    .has_capture_time = true,
    .encode =
        [](const Device&, const DeviceReading& reading, const msg::Header& header, DeviceMessage& message) {
          if (!reading.depth) return false;
          msg::Image depth;
          depth.header = header;
          depth.width = static_cast<std::uint32_t>(reading.depth->width);
          depth.height = static_cast<std::uint32_t>(reading.depth->height);
          depth.encoding = depth_encoding;
          depth.step = depth.width * static_cast<std::uint32_t>(sizeof(float));
          depth.data.resize(reading.depth->meters.size() * sizeof(float));
          std::memcpy(depth.data.data(), reading.depth->meters.data(), depth.data.size());
          msg::encode(depth, message.cdr);
          return true;
        },
    .decode = [](const Device&, mcap::Bytes bytes, DeviceReading& reading) -> Result<bool> {
      msg::Image picture;
      CdrReader reader(bytes);
      if (!msg::decode(reader, picture)) return false;
      const std::size_t pixels = std::size_t{picture.width} * picture.height;
      if (picture.encoding != depth_encoding || picture.data.size() != pixels * sizeof(float)) return false;
      DepthImage depth{static_cast<int>(picture.width), static_cast<int>(picture.height), std::vector<float>(pixels)};
      std::memcpy(depth.meters.data(), picture.data.data(), picture.data.size());
      reading.depth = std::make_shared<const DepthImage>(std::move(depth));
      return true;
    }};

}  // namespace

const ChannelForm depth_kind{.level = ChannelForm::Level::owner,
                             .segment = "depth",
                             .type = msg::Image::type_name,
                             .schema = msg::schema_text<msg::Image>,
                             .stage = Stage::renderer,
                             .groups = depth_groups,
                             .has_series = false,
                             .chunks = mcap::ChunkGroup{2, mcap::Compression::zstd},
                             .measurement = &depth_measurement};

}  // namespace rehearse
