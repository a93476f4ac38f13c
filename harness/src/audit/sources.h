// Which functions answer with something that isn't an input of the controller.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "call_log.h"

namespace rehearse {

struct SymbolSource {
  ObservedCall::Source source;
  std::string name;  // as a person calls it: "clock_gettime", "std::random_device"
};

/// What kind of source a symbol is, by the name under which a library imports it; none: not one that we know.
std::optional<SymbolSource> source_of_symbol(std::string_view symbol);

}  // namespace rehearse
