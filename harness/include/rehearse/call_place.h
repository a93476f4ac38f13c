// CallPlace: the line of a test that called a function of this library, for the text of its exceptions. C++17.
#pragma once

#include <string>

namespace rehearse {

/// A source line. Functions that throw have it as their last parameter, with the default CallPlace::here(): the line of
/// the call. A place without a file is unknown.
struct CallPlace {
  const char* file = nullptr;
  int line = 0;

  static constexpr CallPlace here(const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    return {file, line};
  }
};

/// "tests/hold_test.cpp:12: the model has no joint", or the message alone if the place is unknown.
inline std::string message_at(const CallPlace& place, const std::string& message) {
  return place.file ? std::string(place.file) + ":" + std::to_string(place.line) + ": " + message : message;
}

}  // namespace rehearse
