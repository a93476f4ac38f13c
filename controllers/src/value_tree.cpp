#include <cnoid/MathUtil>
#include <cnoid/ValueTree>

#include "numbers.h"

namespace cnoid {

namespace {

template <class Problem>
[[noreturn]] void fail(const ValueNode& node, const std::string& message) {
  Problem problem;
  problem.setPosition(node.line(), node.column());
  problem.setMessage(message);
  throw problem;
}

const char* kindOf(const ValueNode& node) {
  switch (node.nodeType()) {
    case ValueNode::SCALAR: return "a single value";
    case ValueNode::MAPPING: return "a mapping";
    case ValueNode::LISTING: return "a list";
    case ValueNode::INVALID_NODE: break;
  }
  return "nothing";
}

template <class Problem>
[[noreturn]] void failKind(const ValueNode& node, const char* expected) {
  fail<Problem>(node, std::string(expected) + " is expected here, not " + kindOf(node));
}

template <class T>
T valueOf(const ValueNode& node, const char* expected) {
  T value{};
  if (!node.read(value)) {
    fail<ValueNode::ScalarTypeMismatchException>(node, "\"" + node.toString() + "\" is no " + expected);
  }
  return value;
}

/// A copy of a node with copies of all nodes below it.
ValueNode* deepCopy(const ValueNode& node) {
  if (node.isMapping()) return node.toMapping()->deepClone();
  if (node.isListing()) return node.toListing()->deepClone();
  return node.clone();
}

}  // namespace

// --- ValueNode

ValueNode::~ValueNode() = default;

Referenced* ValueNode::doClone(CloneMap*) const { return new ValueNode(*this); }

void ValueNode::setPosition(int line, int column) {
  line_ = line;
  column_ = column;
}

const std::string& ValueNode::toString() const {
  if (!isScalar()) failKind<NotScalarException>(*this, "a single value");
  return static_cast<const ScalarNode*>(this)->stringValue();
}

int ValueNode::toInt() const { return valueOf<int>(*this, "whole number"); }
double ValueNode::toDouble() const { return valueOf<double>(*this, "number"); }
float ValueNode::toFloat() const { return valueOf<float>(*this, "number"); }
double ValueNode::toAngle() const { return isForcedRadianMode_ ? toDouble() : radian(toDouble()); }
bool ValueNode::toBool() const { return valueOf<bool>(*this, "truth value (true or false)"); }

const Mapping* ValueNode::toMapping() const {
  if (!isMapping()) failKind<NotMappingException>(*this, "a mapping");
  return static_cast<const Mapping*>(this);
}

Mapping* ValueNode::toMapping() { return const_cast<Mapping*>(static_cast<const ValueNode*>(this)->toMapping()); }

const Listing* ValueNode::toListing() const {
  if (!isListing()) failKind<NotListingException>(*this, "a list");
  return static_cast<const Listing*>(this);
}

Listing* ValueNode::toListing() { return const_cast<Listing*>(static_cast<const ValueNode*>(this)->toListing()); }

bool ValueNode::read(int& out) const { return isScalar() && parseNumber(toString(), out); }

bool ValueNode::read(double& out) const { return isScalar() && parseNumber(toString(), out); }

bool ValueNode::read(float& out) const { return isScalar() && parseNumber(toString(), out); }

bool ValueNode::read(bool& out) const {
  if (!isScalar()) return false;
  const std::string& text = toString();
  const bool isTrue = text == "true" || text == "yes" || text == "on";
  const bool isFalse = text == "false" || text == "no" || text == "off";
  if (isTrue || isFalse) out = isTrue;
  return isTrue || isFalse;
}

bool ValueNode::read(std::string& out) const {
  if (!isScalar()) return false;
  out = toString();
  return true;
}

void ValueNode::throwException(const std::string& message) const { fail<Exception>(*this, message); }

ValueNode::Exception::~Exception() = default;

void ValueNode::Exception::setPosition(int line, int column) {
  line_ = line;
  column_ = column;
}

std::string ValueNode::Exception::message() const {
  if (line_ <= 0) return message_;
  return "line " + std::to_string(line_) + ", column " + std::to_string(column_) + ": " + message_;
}

// --- ScalarNode

ScalarNode::ScalarNode(int value) : ScalarNode(std::to_string(value)) {}

ScalarNode::ScalarNode(double value) : ScalarNode(printNumber(value)) {}

Referenced* ScalarNode::doClone(CloneMap*) const { return new ScalarNode(*this); }

// --- Mapping

Mapping::~Mapping() = default;

Mapping* Mapping::notThere() {
  static const MappingPtr node = new Mapping(NotThere());
  return node;
}

Referenced* Mapping::doClone(CloneMap*) const { return new Mapping(*this); }

Mapping* Mapping::deepClone() const {
  Mapping* copy = clone();
  for (auto& entry : copy->values_) entry.second = deepCopy(*entry.second);
  return copy;
}

ValueNode* Mapping::find(const std::string& key) const {
  const auto entry = values_.find(key);
  return entry == values_.end() ? notThere() : entry->second.get();
}

ValueNode* Mapping::find(std::initializer_list<const char*> keys) const { return find(firstFound(keys)); }

Mapping* Mapping::findMapping(const std::string& key) const {
  ValueNode* node = find(key);
  return node->isMapping() ? node->toMapping() : notThere();
}

Listing* Mapping::findListing(const std::string& key) const {
  ValueNode* node = find(key);
  return node->isListing() ? node->toListing() : Listing::notThere();
}

Listing* Mapping::findListing(std::initializer_list<const char*> keys) const {
  ValueNode* node = find(keys);
  return node->isListing() ? node->toListing() : Listing::notThere();
}

ValueNode& Mapping::get(const std::string& key) const {
  ValueNode* node = find(key);
  if (!node->isValid()) throwKeyNotFoundException(key);
  return *node;
}

void Mapping::throwKeyNotFoundException(const std::string& key) const {
  const ValueNode* node = find(key);
  KeyNotFoundException problem;
  problem.setKey(key);
  problem.setPosition(node->isValid() ? node->line() : line(), node->isValid() ? node->column() : column());
  problem.setMessage(node->isValid() ? "the value of \"" + key + "\" is not of the type that is expected here"
                                     : "the key \"" + key + "\" is missing");
  throw problem;
}

std::string Mapping::firstFound(std::initializer_list<const char*> keys) const {
  for (const char* key : keys) {
    if (contains(key)) return key;
  }
  return *keys.begin();
}

void Mapping::insert(const std::string& key, ValueNode* node) { values_[key] = node; }

void Mapping::insert(const Mapping* other) { values_.insert(other->values_.begin(), other->values_.end()); }

ValueNodePtr Mapping::extract(const std::string& key) {
  const auto entry = values_.find(key);
  if (entry == values_.end()) return nullptr;
  const ValueNodePtr node = entry->second;
  values_.erase(entry);
  return node;
}

Mapping* Mapping::openMapping(const std::string& key) {
  Mapping* mapping = findMapping(key);
  return mapping->isValid() ? mapping : createMapping(key);
}

Mapping* Mapping::createMapping(const std::string& key) {
  auto* mapping = new Mapping;
  insert(key, mapping);
  return mapping;
}

Listing* Mapping::openListing(const std::string& key) {
  Listing* listing = findListing(key);
  return listing->isValid() ? listing : createListing(key);
}

Listing* Mapping::createListing(const std::string& key) {
  auto* listing = new Listing;
  insert(key, listing);
  return listing;
}

void Mapping::write(const std::string& key, const std::string& value) { insert(key, new ScalarNode(value)); }
void Mapping::write(const std::string& key, const char* value) { insert(key, new ScalarNode(std::string(value))); }
void Mapping::write(const std::string& key, bool value) { write(key, value ? "true" : "false"); }
void Mapping::write(const std::string& key, int value) { insert(key, new ScalarNode(value)); }
void Mapping::write(const std::string& key, double value) { insert(key, new ScalarNode(value)); }

// --- Listing

Listing::~Listing() = default;

Listing* Listing::notThere() {
  static const ListingPtr node = new Listing(NotThere());
  return node;
}

Referenced* Listing::doClone(CloneMap*) const { return new Listing(*this); }

Listing* Listing::deepClone() const {
  Listing* copy = clone();
  for (auto& node : copy->values_) node = deepCopy(*node);
  return copy;
}

ValueNode* Listing::at(int index) const {
  if (index < 0 || index >= size()) {
    throwException("element " + std::to_string(index) + " is asked for in a list of " + std::to_string(size()));
  }
  return values_[static_cast<std::size_t>(index)].get();
}

void Listing::append(int value) { append(new ScalarNode(value)); }
void Listing::append(double value) { append(new ScalarNode(value)); }
void Listing::append(const std::string& value) { append(new ScalarNode(value)); }

Mapping* Listing::newMapping() {
  auto* mapping = new Mapping;
  append(mapping);
  return mapping;
}

bool Mapping::readAngle(const std::string& key, double& angle, const ValueNode* unitNode) const {
  if (!read(key, angle)) return false;
  if (!(unitNode ? unitNode : this)->isForcedRadianMode()) angle = radian(angle);
  return true;
}

bool Mapping::readAngle(const std::string& key, float& angle, const ValueNode* unitNode) const {
  double read = 0.0;
  if (!readAngle(key, read, unitNode)) return false;
  angle = static_cast<float>(read);
  return true;
}

bool Mapping::readAngle(std::initializer_list<const char*> keys, double& angle, const ValueNode* unitNode) const {
  for (const char* key : keys)
    if (readAngle(std::string(key), angle, unitNode)) return true;
  return false;
}

bool Mapping::readAngle(std::initializer_list<const char*> keys, float& angle, const ValueNode* unitNode) const {
  for (const char* key : keys)
    if (readAngle(std::string(key), angle, unitNode)) return true;
  return false;
}

}  // namespace cnoid
