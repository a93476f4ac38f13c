#include <cnoid/Body>
#include <cnoid/LinkGroup>
#include <cnoid/ValueTree>

namespace cnoid {

LinkGroup* LinkGroup::create(const Body* body) {
  auto* group = new LinkGroup;
  group->setName("Whole Body");
  const Listing* links = body->info()->findListing({"link_group", "linkGroup"});
  if (links->isValid()) {
    group->read(*body, *links);
  } else {
    for (int i = 0; i < body->numLinks(); ++i) group->elements_.emplace_back(i);
  }
  return group;
}

void LinkGroup::read(const Body& body, const Listing& links) {
  for (const auto& node : links) {
    if (node->isMapping()) {
      const Mapping* part = node->toMapping();
      const LinkGroupPtr group = new LinkGroup;
      group->setName(part->get<std::string>("name"));
      group->read(body, *part->get("links").toListing());
      elements_.emplace_back(group);
    } else if (const Link* link = body.link(node->toString())) {
      elements_.emplace_back(link->index());
    }
  }
}

LinkGroup* LinkGroup::findSubGroup(const std::string& name) const {
  for (int i = 0; i < numElements(); ++i) {
    if (!checkIfGroup(i)) continue;
    if (group(i)->name() == name) return group(i);
    if (LinkGroup* found = group(i)->findSubGroup(name)) return found;
  }
  return nullptr;
}

}  // namespace cnoid
