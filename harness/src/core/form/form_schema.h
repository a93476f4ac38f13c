// JSON Schemas of forms.
#pragma once

#include <string>

#include "form.h"

namespace rehearse {

/// The JSON Schema (draft 2020-12) of the values of the type, with a newline at its end. Forms inside are definitions.
/// A map that isn't described allows no other keys.
std::string schema_text(std::string_view title, const ValueType& type);

}  // namespace rehearse
