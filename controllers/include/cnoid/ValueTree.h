// Mapping: named values, as structured options give them. Only scalars; what is nested waits for a use.
#pragma once

#include "Config.h"
#include "Referenced.h"

#include <map>
#include <string>

namespace cnoid {

class CNOID_GENERAL_EXPORT Mapping : public Referenced {
 public:
  ~Mapping() override;

  bool empty() const { return values_.empty(); }
  int size() const { return static_cast<int>(values_.size()); }
  bool contains(const std::string& key) const { return values_.count(key) != 0; }

  void write(const std::string& key, const std::string& value);
  void write(const std::string& key, const char* value);
  void write(const std::string& key, bool value);
  void write(const std::string& key, int value);
  void write(const std::string& key, double value);

  /// Reads a value into `out`. False, `out` untouched, if the key is missing or its text is not of that type.
  /// Numbers always have '.' as their decimal point; booleans are true, yes, on and false, no, off.
  bool read(const std::string& key, std::string& out) const;
  bool read(const std::string& key, bool& out) const;
  bool read(const std::string& key, int& out) const;
  bool read(const std::string& key, double& out) const;

  /// The value, or the default if it can't be read.
  template <typename T>
  T get(const std::string& key, const T& defaultValue) const {
    T value = defaultValue;
    return read(key, value) ? value : defaultValue;
  }
  std::string get(const std::string& key, const char* defaultValue) const {
    return get(key, std::string(defaultValue));
  }

 private:
  std::map<std::string, std::string> values_;
};

using MappingPtr = ref_ptr<Mapping>;

}  // namespace cnoid
