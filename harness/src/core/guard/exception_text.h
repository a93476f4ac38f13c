// ExceptionText: exceptions of controllers, for a person.
#pragma once

#include <string>
#include <string_view>

namespace rehearse {

/// Text that a controller made, for a message: lines are separated by " | ", control characters and bytes that aren't
/// UTF-8 are written as \xNN, and a long text ends with "...".
std::string text_of_controller(std::string_view text);

/// In a handler of an exception: "threw std::runtime_error: no gait".
std::string describe_exception();

/// In a handler of std::terminate(): what led to it.
std::string describe_termination();

}  // namespace rehearse
