// Converts the contacts of a link to messages and back.
#pragma once

#include <rehearse/io.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>

#include <vector>

namespace rehearse {

/// Replaces the contacts of the message; its header is not changed.
inline void put_contacts(const std::vector<ContactReading>& contacts, msg::Contacts& message) {
  message.contacts.resize(contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const ContactReading& from = contacts[i];
    message.contacts[i] = {{from.position.x(), from.position.y(), from.position.z()},
                           {from.normal.x(), from.normal.y(), from.normal.z()},
                           {from.force.x(), from.force.y(), from.force.z()},
                           {from.velocity.x(), from.velocity.y(), from.velocity.z()},
                           from.depth};
  }
}

inline std::vector<ContactReading> contacts_of(const msg::Contacts& message) {
  std::vector<ContactReading> contacts;
  for (const msg::Contact& c : message.contacts)
    contacts.push_back({{c.position.x, c.position.y, c.position.z},
                        {c.normal.x, c.normal.y, c.normal.z},
                        {c.force.x, c.force.y, c.force.z},
                        {c.velocity.x, c.velocity.y, c.velocity.z},
                        c.depth});
  return contacts;
}

}  // namespace rehearse
