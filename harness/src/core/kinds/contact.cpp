// The measurement of a contact sensor.
#include "kind.h"
#include "rows.h"
#include "vector_messages.h"

namespace rehearse {
namespace {

constexpr ElementGroup contact_groups[] = {{"count", ""}, {"force", "N", "xyz"}};

/// A log may state any number; one that is no count is none.
std::uint32_t count_of(double number) {
  return number >= 0.0 && number <= 0xffffffff ? static_cast<std::uint32_t>(number) : 0;
}

constexpr NumberMessage contact_numbers{
    .encode =
        [](const msg::Header& header, std::span<const double> numbers, CdrWriter& cdr) {
          msg::encode(msg::ContactForce{header, count_of(numbers[0]), vector3(&numbers[1])}, cdr);
        },
    .decode =
        [](mcap::Bytes bytes, std::vector<double>& numbers) {
          msg::ContactForce message;
          CdrReader reader(bytes);
          if (!msg::decode(reader, message)) return false;
          numbers = {static_cast<double>(message.count), message.force.x, message.force.y, message.force.z};
          return true;
        }};

constexpr LogInput contact_input{.content = LogInput::Content::numbers,
                                 .key = "contacts",
                                 .form = "contact_source",
                                 .owner = "a contact sensor",
                                 .devices = "contact sensors",
                                 .messages = "a ContactForce",
                                 .can_interpolate = false};
constexpr DeviceMeasurement contact_measurement{.log = contact_input};

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
                               .numbers = &contact_numbers,
                               .measurement = &contact_measurement};

}  // namespace rehearse
