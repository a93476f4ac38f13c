// Temporarily changes the environment variable of Choreonoid's share folder.
#pragma once

#include <cstdlib>
#include <string>

namespace rehearse::test {

/// Sets the variable, or unsets it with null; the destructor restores the old value.
class ShareVariable {
 public:
  explicit ShareVariable(const char* value) {
    if (const char* old = std::getenv(name)) {
      had_one_ = true;
      old_ = old;
    }
    value ? setenv(name, value, 1) : unsetenv(name);
  }
  ~ShareVariable() { had_one_ ? setenv(name, old_.c_str(), 1) : unsetenv(name); }
  ShareVariable(const ShareVariable&) = delete;
  ShareVariable& operator=(const ShareVariable&) = delete;

 private:
  static constexpr const char* name = "REHEARSE_CHOREONOID_SHARE";
  bool had_one_ = false;
  std::string old_;
};

}  // namespace rehearse::test
