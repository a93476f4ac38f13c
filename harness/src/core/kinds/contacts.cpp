// All contacts of a link, as a controller reads them.
#include "number_message.h"
#include "vector_messages.h"

namespace rehearse {
namespace {

constexpr ElementGroup contacts_groups[] = {{"position", "m", "xyz"},
                                            {"normal", "unit vector", "xyz"},
                                            {"force", "N", "xyz"},
                                            {"velocity", "m/s", "xyz"},
                                            {"depth", "m"}};

std::array<double*, 13> places_of_contact(msg::Contact& c) {
  return {&c.position.x, &c.position.y, &c.position.z, &c.normal.x,   &c.normal.y,   &c.normal.z, &c.force.x,
          &c.force.y,    &c.force.z,    &c.velocity.x, &c.velocity.y, &c.velocity.z, &c.depth};
}

}  // namespace

const ChannelForm contacts_kind{
    .level = ChannelForm::Level::owner,
    .segment = "contacts",
    .type = msg::Contacts::type_name,
    .schema = msg::schema_text<msg::Contacts>,
    .stage = Stage::physics,
    .groups = contacts_groups,
    .is_state = true,
    .of_link = ChannelForm::OfLink::always,
    // If a row has fewer points than others, the missing ones are NaN; `count` is the number of points.
    .make_rows =
        [](TraceChannel& channel, const std::string&) {
          return rows_of<msg::Contacts>(channel, [](msg::Contacts& message, RowWriter& row) {
            row.put("contacts/count", CellKind::unsigned_integer, message.contacts.size());
            for (std::size_t i = 0; i < message.contacts.size(); ++i) {
              std::string prefix = "contacts/" + std::to_string(i) + "/";
              put_after(prefix, ChannelKind::contacts, places_of_contact(message.contacts[i]), row);
            }
          });
        },
    .read_link =
        [](mcap::Bytes bytes, int link, BodyObservation& body) {
          msg::Contacts message;
          CdrReader reader(bytes);
          if (!msg::decode(reader, message)) return false;
          body.contacts[link].clear();
          for (const msg::Contact& contact : message.contacts)
            body.contacts[link].push_back({eigen_vector(contact.position), eigen_vector(contact.normal),
                                           eigen_vector(contact.force), eigen_vector(contact.velocity), contact.depth});
          return true;
        }};

}  // namespace rehearse
