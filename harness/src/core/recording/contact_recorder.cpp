#include "contact_recorder.h"

#include "core/kinds/vector_messages.h"

namespace rehearse {

ContactRecorder::ContactRecorder(TraceOutput& output, const Scenario& scenario)
    : channel_(output.channel<msg::ContactChange>(ChannelName::of_run(ChannelKind::contact_changes))) {
  for (const ScenarioBody& body : scenario.bodies) {
    std::vector<std::string>& names = names_.emplace_back();
    for (const Link& link : body.model->links) names.push_back(body.name + "/" + link.name);
  }
}

Result<void> ContactRecorder::write(TraceOutput& output, std::int64_t tick, const std::vector<LinkPair>& touching) {
  if (touching == touching_) return {};
  auto before = touching_.begin();
  auto now = touching.begin();
  while (before != touching_.end() || now != touching.end()) {
    const bool ends = now == touching.end() || (before != touching_.end() && *before < *now);
    const bool begins = !ends && (before == touching_.end() || *now < *before);
    if (ends || begins) REHEARSE_TRY(write_change(output, tick, ends ? *before : *now, begins));
    if (!begins) ++before;
    if (!ends) ++now;
  }
  touching_ = touching;
  return {};
}

Result<void> ContactRecorder::write_change(TraceOutput& output, std::int64_t tick, const LinkPair& pair, bool begins) {
  msg::ContactChange change;
  change.stamp = output.stamp(tick);
  change.tick = tick;
  change.link = names_[pair.body][pair.link];
  change.other = names_[pair.other_body][pair.other_link];
  change.begins = begins;
  return output.write(channel_, tick, change);
}

Result<void> ContactRecorder::write_input(TraceOutput& output, std::int64_t tick,
                                          const std::vector<std::uint16_t>& channels,
                                          const std::vector<std::vector<ContactReading>>& contacts) {
  for (std::size_t i = 0; i < channels.size(); ++i) {
    input_message_.header = {output.stamp(tick), "world"};
    input_message_.contacts.clear();
    for (const ContactReading& contact : contacts[i])
      input_message_.contacts.push_back({point(contact.position.data()), vector3(contact.normal),
                                         vector3(contact.force), vector3(contact.velocity), contact.depth});
    REHEARSE_TRY(output.write(channels[i], tick, input_message_));
  }
  return {};
}

}  // namespace rehearse
