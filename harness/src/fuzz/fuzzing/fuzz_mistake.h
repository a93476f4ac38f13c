// FuzzMistake: a mistake of a plan or of a file, as functions of fuzz.h throw it. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <stdexcept>
#include <type_traits>
#include <utility>

namespace rehearse {

struct FuzzMistake : std::runtime_error {
  explicit FuzzMistake(Diagnostics found) : std::runtime_error(to_string(found)), diagnostics(std::move(found)) {}
  Diagnostics diagnostics;
};

/// The value. Throws FuzzMistake if there is none.
template <class T>
T checked(Result<T> result) {
  if (!result) throw FuzzMistake(result.errors());
  if constexpr (!std::is_void_v<T>) return *std::move(result);
}

}  // namespace rehearse
