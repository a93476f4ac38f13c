// Tables of the keys of forms, in Markdown, for the pages of the reference.
#pragma once

#include <string>

#include "form.h"

namespace rehearse {

/// The keys of the form with their texts, the values that they accept, and their defaults. Each row ends with a newline.
std::string table_text(const Form& form);

/// The form of that name in the type, or in a part of it; null: there is none.
const Form* find_form(const ValueType& type, std::string_view name);

}  // namespace rehearse
