#include <cnoid/ValueTree>

#include "numbers.h"

namespace cnoid {

Mapping::~Mapping() = default;

void Mapping::write(const std::string& key, const std::string& value) { values_[key] = value; }
void Mapping::write(const std::string& key, const char* value) { values_[key] = value; }
void Mapping::write(const std::string& key, bool value) { values_[key] = value ? "true" : "false"; }
void Mapping::write(const std::string& key, int value) { values_[key] = std::to_string(value); }
void Mapping::write(const std::string& key, double value) { values_[key] = printNumber(value); }

bool Mapping::read(const std::string& key, std::string& out) const {
  const auto entry = values_.find(key);
  if (entry == values_.end()) return false;
  out = entry->second;
  return true;
}

bool Mapping::read(const std::string& key, bool& out) const {
  std::string text;
  if (!read(key, text)) return false;
  const bool isTrue = text == "true" || text == "yes" || text == "on";
  const bool isFalse = text == "false" || text == "no" || text == "off";
  if (isTrue || isFalse) out = isTrue;
  return isTrue || isFalse;
}

bool Mapping::read(const std::string& key, int& out) const {
  std::string text;
  return read(key, text) && parseNumber(text, out);
}

bool Mapping::read(const std::string& key, double& out) const {
  std::string text;
  return read(key, text) && parseNumber(text, out);
}

}  // namespace cnoid
