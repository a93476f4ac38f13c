#include "event_stream.h"

#include <rehearse/cdr.h>
#include <rehearse/mcap.h>

#include <cstdint>
#include <vector>

namespace rehearse {

EventStream::EventStream(const Trace& trace) : held_(trace.events_.get()) {
  if (held_) return;
  std::vector<std::uint16_t> ids;
  for (const auto& [id, channel] : trace.reader_->channels()) {
    const mcap::Schema* schema = trace.reader_->schema_of(channel);
    if (schema && schema->name == msg::Event::type_name && channel.message_encoding == "cdr") ids.push_back(id);
  }
  if (!ids.empty()) messages_ = std::make_unique<mcap::OrderedMessages>(*trace.reader_, ids);
}

const msg::Event* EventStream::next() {
  if (held_) return index_ < held_->size() ? &(*held_)[index_++] : nullptr;
  while (messages_) {
    const mcap::Message* message = messages_->next();
    if (!message) break;
    CdrReader reader(message->data);
    if (msg::decode(reader, event_)) return &event_;
  }
  return nullptr;
}

const std::vector<msg::Event>& Trace::events() const {
  if (!events_) {
    auto all = std::make_shared<std::vector<msg::Event>>();
    EventStream stream(*this);
    while (const msg::Event* event = stream.next()) all->push_back(*event);
    events_ = std::move(all);
  }
  return *events_;
}

}  // namespace rehearse
