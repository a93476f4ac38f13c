#include "damage_log.h"

namespace rehearse::mcap {

void DamageLog::add(std::string message) {
  if (list_.size() > limit) return;
  if (list_.size() == limit) message = "and more damage after that";
  list_.push_back(error(std::move(message)));
  list_.back().file = file_;
}

void DamageLog::add(const DamageLog& other) {
  for (const Diagnostic& diagnostic : other.list_) add(diagnostic.message);
}

}  // namespace rehearse::mcap
