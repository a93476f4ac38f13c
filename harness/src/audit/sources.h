// The system functions whose answers aren't inputs of a controller.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "call_log.h"

namespace rehearse {

struct SymbolSource {
  ObservedCall::Source source;
  std::string name;  // as people call it: "clock_gettime", "std::random_device"
};

/// The kind of source of a symbol, by the name under which a library imports it; none: not a known source.
std::optional<SymbolSource> source_of_symbol(std::string_view symbol);

}  // namespace rehearse
