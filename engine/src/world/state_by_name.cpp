#include "state_by_name.h"

#include <algorithm>
#include <cstring>

namespace rehearse {

void StateByName::enter(const std::string& body, const std::string& owner, StatePart part) {
  current_ = &parts_[{body, owner, part}];
}

void StateByName::take(void* data, std::size_t size) {
  const auto* bytes = static_cast<const std::byte*>(data);
  current_->insert(current_->end(), bytes, bytes + size);
}

const std::vector<std::byte>* StateByName::find(const Name& name) const {
  const auto found = parts_.find(name);
  return found == parts_.end() ? nullptr : &found->second;
}

bool StateByName::has_body(const std::string& body) const {
  return std::ranges::any_of(parts_, [&](const auto& part) { return std::get<0>(part.first) == body; });
}

void StateTaker::enter(const std::string& body, const std::string& owner, StatePart part) {
  end_part();
  name_ = {body, owner, part};
  current_ = state_.find(name_);
  at_ = 0;
}

void StateTaker::take(void* data, std::size_t size) {
  if (current_ && at_ + size <= current_->size()) std::memcpy(data, current_->data() + at_, size);
  at_ += size;
}

/// A part of a different size has a different meaning: the body has become kinematic, or the joint a track. The state
/// of an actuator or a sleeper may be missing: a world with others begins with theirs at rest.
void StateTaker::end_part() {
  const auto& [body, owner, part] = name_;
  const bool matters = part != StatePart::wrench && part != StatePart::contact && part != StatePart::gear &&
                       part != StatePart::commands && part != StatePart::lock && part != StatePart::heat &&
                       part != StatePart::rest;
  if (!matters || at_ == (current_ ? current_->size() : 0)) return;
  std::string what = "body '" + body + "'";
  if (body.empty())
    what = "connection '" + owner + "'";
  else if (state_.has_body(body))
    what += (part == StatePart::motion ? ": link '" : ": joint '") + owner + "'";
  if (told_.insert(what).second) missing_.push_back(error(what + " isn't in the state"));
}

const Diagnostics& StateTaker::missing() {
  end_part();
  at_ = 0;
  name_ = {"", "", StatePart::wrench};
  return missing_;
}

}  // namespace rehearse
