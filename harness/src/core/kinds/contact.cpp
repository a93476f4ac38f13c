// The measurement of a contact sensor.
#include "kind.h"
#include "rows.h"
#include "vector_messages.h"

namespace rehearse {
namespace {

constexpr ElementGroup contact_groups[] = {{"count", ""}, {"force", "N", "xyz"}};

constexpr DeviceMeasurement contact_measurement{
    .is_of = [](const Device& device) { return std::holds_alternative<ContactSensor>(device.kind); },
    .encode =
        [](const Device&, const DeviceReading& reading, const msg::Header& header, DeviceMessage& message) {
          const auto count = static_cast<std::uint32_t>(reading.values[0]);
          msg::encode(msg::ContactForce{header, count, vector3(&reading.values[1])}, message.cdr);
          return true;
        },
    .decode = [](const Device&, mcap::Bytes bytes, DeviceReading& reading) -> Result<bool> {
      msg::ContactForce message;
      CdrReader reader(bytes);
      if (!msg::decode(reader, message)) return false;
      reading.values = {static_cast<double>(message.count), message.force.x, message.force.y, message.force.z};
      return true;
    }};

}  // namespace

const ChannelForm contact_kind{.level = ChannelForm::Level::owner,
                               .segment = "contact",
                               .type = msg::ContactForce::type_name,
                               .schema = msg::schema_text<msg::ContactForce>,
                               .stage = Stage::sensors,
                               .groups = contact_groups,
                               .has_fixed_elements = true,
                               .is_state = true,
                               .make_rows =
                                   [](TraceChannel& channel, const std::string&) {
                                     return rows_of<msg::ContactForce>(
                                         channel, [](const msg::ContactForce& message, RowWriter& row) {
                                           row.put("count", CellKind::unsigned_integer, message.count);
                                           row.put("force/x", message.force.x);
                                           row.put("force/y", message.force.y);
                                           row.put("force/z", message.force.z);
                                         });
                                   },
                               .measurement = &contact_measurement};

}  // namespace rehearse
