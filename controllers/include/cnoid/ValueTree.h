// ValueTree: data in the form of YAML: scalars, mappings from keys to nodes, listings of nodes.
//
// A model's extra information (Link::info, Device::info), structured options and .seq files use this form. Nodes that
// were read from a text store their line and column. A missing key gives a node that is not valid, never null, so that
// calls can be chained: `info->findMapping("a")->findListing("b")->isValid()`. A function that requires a value throws
// a ValueNode::Exception, which names the place, if the value is missing or has a different type.
#pragma once

#include "ClonableReferenced.h"
#include "Config.h"

#include <initializer_list>
#include <map>
#include <string>
#include <vector>

namespace cnoid {

class ScalarNode;
class Mapping;
class Listing;

class CNOID_GENERAL_EXPORT ValueNode : public ClonableReferenced {
 public:
  enum NodeType { INVALID_NODE = 0, SCALAR = 1, MAPPING = 2, LISTING = 4 };

  /// A node that represents a missing value.
  ValueNode() = default;
  ValueNode& operator=(const ValueNode&) = delete;
  ~ValueNode() override;

  /// A new copy. A copy of a mapping or a listing has the same children; see deepClone().
  ValueNode* clone() const { return static_cast<ValueNode*>(doClone(nullptr)); }

  NodeType nodeType() const { return type_; }
  bool isValid() const { return type_ != INVALID_NODE; }
  explicit operator bool() const { return isValid(); }
  bool isScalar() const { return type_ == SCALAR; }
  bool isString() const { return type_ == SCALAR; }
  bool isMapping() const { return type_ == MAPPING; }
  bool isListing() const { return type_ == LISTING; }
  bool isCollection() const { return isMapping() || isListing(); }

  // These functions throw NotScalarException, NotMappingException, NotListingException if the node has a different
  // kind, and ScalarTypeMismatchException if the text can't be converted to the type. Numbers always have '.' as their
  // decimal point, and are decimal; booleans are true, yes, on and false, no, off.

  int toInt() const;
  double toDouble() const;
  float toFloat() const;
  bool toBool() const;
  /// A number of degrees as radians, unless the node is in the mode of radians.
  [[deprecated("Check isForcedRadianMode() of the top node.")]] double toAngle() const;
  const std::string& toString() const;
  operator const std::string&() const { return toString(); }
  template <typename T>
  T to() const;
  const Mapping* toMapping() const;
  Mapping* toMapping();
  const Listing* toListing() const;
  Listing* toListing();
  bool isSequence() const { return isListing(); }  // old names
  const Listing* toSequence() const { return toListing(); }
  Listing* toSequence() { return toListing(); }

  /// The same without exceptions: returns false and leaves `out` unchanged if the value can't be read.
  bool read(int& out) const;
  bool read(double& out) const;
  bool read(float& out) const;
  bool read(bool& out) const;
  bool read(std::string& out) const;

  /// Angles are in degrees unless somebody sets this mode. A copy of the node has the same.
  bool isForcedRadianMode() const { return isForcedRadianMode_; }
  void setForcedRadianMode(bool on = true) { isForcedRadianMode_ = on; }
  [[deprecated("Use isForcedRadianMode.")]] bool isDegreeMode() const { return !isForcedRadianMode_; }
  [[deprecated("Use setForcedRadianMode.")]] void setDegreeMode() { isForcedRadianMode_ = false; }

  /// True if the node was read from a text; then line() and column() count from 1.
  bool hasLineInfo() const { return line_ > 0; }
  int line() const { return line_; }
  int column() const { return column_; }
  void setPosition(int line, int column);

  class CNOID_GENERAL_EXPORT Exception {
   public:
    virtual ~Exception();
    /// The error message, with the prefix "line L, column C: " if the place is known.
    std::string message() const;
    /// The error message without the place.
    const std::string& text() const { return message_; }
    /// Counts from 1; 0 if the place is not known.
    int line() const { return line_; }
    int column() const { return column_; }
    void setPosition(int line, int column);
    void setMessage(const std::string& message) { message_ = message; }

   private:
    std::string message_;
    int line_ = 0;
    int column_ = 0;
  };
  class CNOID_GENERAL_EXPORT NotScalarException : public Exception {};
  class CNOID_GENERAL_EXPORT NotMappingException : public Exception {};
  class CNOID_GENERAL_EXPORT NotListingException : public Exception {};
  class CNOID_GENERAL_EXPORT ScalarTypeMismatchException : public Exception {};
  class CNOID_GENERAL_EXPORT SyntaxException : public Exception {};
  class CNOID_GENERAL_EXPORT FileException : public Exception {};
  class CNOID_GENERAL_EXPORT KeyNotFoundException : public Exception {
   public:
    const std::string& key() const { return key_; }
    void setKey(const std::string& key) { key_ = key; }

   private:
    std::string key_;
  };

  /// Throws an Exception with this node's place.
  [[noreturn]] void throwException(const std::string& message) const;

 protected:
  explicit ValueNode(NodeType type) : type_(type) {}
  ValueNode(const ValueNode&) = default;
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  NodeType type_ = INVALID_NODE;
  int line_ = 0;
  int column_ = 0;
  bool isForcedRadianMode_ = false;
};

template <>
inline int ValueNode::to<int>() const {
  return toInt();
}
template <>
inline double ValueNode::to<double>() const {
  return toDouble();
}
template <>
inline float ValueNode::to<float>() const {
  return toFloat();
}
template <>
inline bool ValueNode::to<bool>() const {
  return toBool();
}
template <>
inline std::string ValueNode::to<std::string>() const {
  return toString();
}

using ValueNodePtr = ref_ptr<ValueNode>;

class CNOID_GENERAL_EXPORT ScalarNode : public ValueNode {
 public:
  explicit ScalarNode(const std::string& value) : ValueNode(SCALAR), value_(value) {}
  explicit ScalarNode(int value);
  /// Stores a number as the shortest text that reads back as the same number.
  explicit ScalarNode(double value);

  const std::string& stringValue() const { return value_; }

 protected:
  ScalarNode(const ScalarNode&) = default;
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  std::string value_;
};

using ScalarNodePtr = ref_ptr<ScalarNode>;

/// Keys are kept in alphabetical order.
class CNOID_GENERAL_EXPORT Mapping : public ValueNode {
  using Container = std::map<std::string, ValueNodePtr>;

 public:
  using iterator = Container::iterator;
  using const_iterator = Container::const_iterator;

  Mapping() : ValueNode(MAPPING) {}
  ~Mapping() override;

  Mapping* clone() const { return static_cast<Mapping*>(doClone(nullptr)); }
  /// A new copy that shares no node with this one.
  Mapping* deepClone() const;

  bool empty() const { return values_.empty(); }
  int size() const { return static_cast<int>(values_.size()); }
  bool contains(const std::string& key) const { return values_.count(key) != 0; }
  void clear() { values_.clear(); }
  iterator begin() { return values_.begin(); }
  iterator end() { return values_.end(); }
  const_iterator begin() const { return values_.begin(); }
  const_iterator end() const { return values_.end(); }

  /// A node that is not valid if the key is missing. With several keys: the first one that exists.
  ValueNode* find(const std::string& key) const;
  ValueNode* find(std::initializer_list<const char*> keys) const;
  /// Not valid, too, if the value has a different kind.
  Mapping* findMapping(const std::string& key) const;
  Listing* findListing(const std::string& key) const;
  Listing* findListing(std::initializer_list<const char*> keys) const;
  /// Throws KeyNotFoundException if the key is missing.
  ValueNode& get(const std::string& key) const;
  ValueNode& operator[](const std::string& key) const { return get(key); }

  /// Replaces an existing value. The mapping shares the node with its other owners.
  void insert(const std::string& key, ValueNode* node);
  /// Inserts the values of the other mapping whose keys this mapping doesn't contain.
  void insert(const Mapping* other);
  bool remove(const std::string& key) { return values_.erase(key) != 0; }
  /// Removes a value and returns it, or null if the key is missing.
  ValueNodePtr extract(const std::string& key);
  /// The mapping, or listing, under the key. open: makes one if there is none; create: always makes a new one.
  Mapping* openMapping(const std::string& key);
  Mapping* createMapping(const std::string& key);
  Listing* openListing(const std::string& key);
  Listing* createListing(const std::string& key);
  Listing* findSequence(const std::string& key) const { return findListing(key); }  // old names
  Listing* openSequence(const std::string& key) { return openListing(key); }
  Listing* createSequence(const std::string& key) { return createListing(key); }

  void write(const std::string& key, const std::string& value);
  void write(const std::string& key, const char* value);
  void write(const std::string& key, bool value);
  void write(const std::string& key, int value);
  void write(const std::string& key, double value);
  void write(const std::string& key, ValueNode* node) { insert(key, node); }

  /// Reads a value into `out`. Returns false and leaves `out` unchanged if the key is missing or its value has a
  /// different type.
  template <typename T>
  bool read(const std::string& key, T& out) const {
    return find(key)->read(out);
  }
  template <typename T>
  bool read(std::initializer_list<const char*> keys, T& out) const {
    return find(keys)->read(out);
  }

  /// Likewise an angle, in radians. The text's is in degrees, unless this node, or the given one, is in the mode of
  /// radians.
  bool readAngle(const std::string& key, double& angle, const ValueNode* unitNode = nullptr) const;
  bool readAngle(const std::string& key, float& angle, const ValueNode* unitNode = nullptr) const;
  bool readAngle(std::initializer_list<const char*> keys, double& angle, const ValueNode* unitNode = nullptr) const;
  bool readAngle(std::initializer_list<const char*> keys, float& angle, const ValueNode* unitNode = nullptr) const;

  /// The value; throws KeyNotFoundException if it can't be read.
  template <typename T>
  T get(const std::string& key) const {
    T value{};
    if (!read(key, value)) throwKeyNotFoundException(key);
    return value;
  }
  template <typename T>
  T get(std::initializer_list<const char*> keys) const {
    T value{};
    if (!read(keys, value)) throwKeyNotFoundException(firstFound(keys));
    return value;
  }
  /// The value, or the default if it can't be read.
  template <typename T>
  T get(const std::string& key, const T& defaultValue) const {
    T value = defaultValue;
    return read(key, value) ? value : defaultValue;
  }
  template <typename T>
  T get(std::initializer_list<const char*> keys, const T& defaultValue) const {
    T value = defaultValue;
    return read(keys, value) ? value : defaultValue;
  }
  std::string get(const std::string& key, const char* defaultValue) const {
    return get(key, std::string(defaultValue));
  }

 protected:
  Mapping(const Mapping&) = default;
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  friend class ValueNode;
  struct NotThere {};
  explicit Mapping(NotThere) : ValueNode(INVALID_NODE) {}
  static Mapping* notThere();
  [[noreturn]] void throwKeyNotFoundException(const std::string& key) const;
  /// Or the first value of all, if none of them exists.
  std::string firstFound(std::initializer_list<const char*> keys) const;

  Container values_;
};

using MappingPtr = ref_ptr<Mapping>;

class CNOID_GENERAL_EXPORT Listing : public ValueNode {
  using Container = std::vector<ValueNodePtr>;

 public:
  using iterator = Container::iterator;
  using const_iterator = Container::const_iterator;

  Listing() : ValueNode(LISTING) {}
  ~Listing() override;

  Listing* clone() const { return static_cast<Listing*>(doClone(nullptr)); }
  /// A new copy that shares no node with this one.
  Listing* deepClone() const;

  bool empty() const { return values_.empty(); }
  int size() const { return static_cast<int>(values_.size()); }
  void clear() { values_.clear(); }
  void reserve(int size) { values_.reserve(static_cast<std::size_t>(size)); }
  iterator begin() { return values_.begin(); }
  iterator end() { return values_.end(); }
  const_iterator begin() const { return values_.begin(); }
  const_iterator end() const { return values_.end(); }

  /// Throws an Exception if the element doesn't exist (Choreonoid does not check).
  ValueNode* at(int index) const;
  ValueNode& get(int index) const { return *at(index); }
  ValueNode& operator[](int index) const { return *at(index); }
  ValueNode* front() const { return at(0); }
  ValueNode* back() const { return at(size() - 1); }

  void append(ValueNode* node) { values_.emplace_back(node); }
  void append(int value);
  void append(double value);
  void append(const std::string& value);
  /// Appends a new mapping.
  Mapping* newMapping();

 protected:
  Listing(const Listing&) = default;
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  friend class Mapping;
  struct NotThere {};
  explicit Listing(NotThere) : ValueNode(INVALID_NODE) {}
  static Listing* notThere();

  Container values_;
};

using ListingPtr = ref_ptr<Listing>;

// Names of earlier releases
using YamlNode = ValueNode;
using YamlNodePtr = ValueNodePtr;
using YamlScalar = ScalarNode;
using YamlMapping = Mapping;
using YamlMappingPtr = MappingPtr;
using YamlSequence = Listing;
using YamlSequencePtr = ListingPtr;
using Sequence = Listing;
using SequencePtr = ListingPtr;

}  // namespace cnoid
