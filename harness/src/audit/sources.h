// Which functions answer with something that isn't an input of the controller.
#pragma once

#include <optional>
#include <string_view>

#include "audit/call_log.h"

namespace rehearse {

/// What kind of source a symbol is, by the name under which a library imports it; none: not one that we know.
std::optional<ObservedCall::Source> source_of_symbol(std::string_view symbol);

}  // namespace rehearse
