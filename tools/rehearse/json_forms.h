// The forms of the objects that verbs print with --json. A member without a row here fails
// tests/tools/schema_test.py, which validates the output of each verb.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/form/form.h"

namespace rehearse::tool {

/// An object of a verb: the name of its schema, and its form.
struct NamedForm {
  std::string_view name;
  std::string_view title;
  ValueType type;
};

/// What each verb prints, by name.
std::vector<NamedForm> verdict_objects();
std::vector<NamedForm> log_objects();
std::vector<NamedForm> file_objects();
std::vector<NamedForm> golden_objects();
std::vector<NamedForm> campaign_objects();

/// A member that is always there.
inline FormKey member(std::string_view name, ValueType type) { return {name, std::move(type), "", required}; }
/// A member that isn't always there.
inline FormKey member_if(std::string_view name, std::string_view when, ValueType type) {
  return {name, std::move(type), when, ""};
}

/// One of the forms, or the errors of a verb that fails.
NamedForm object_of(std::string_view name, std::string_view title, std::vector<const Form& (*)()> forms);

/// The form, with the version of the form as its first member.
Form with_version(Form form);

// Parts of several objects.
ValueType difference_type();     // null, or the first difference
ValueType findings_type();       // a list of remarks or errors
ValueType expectations_type();   // a list of judged expectations
ValueType control_times_type();  // a list of the controllers' times
ValueType interval_type();       // [low, high]
const Form& comparison_form();
const Form& errors_form();  // of a verb that fails
const Form& cost_count_form();
ValueType word_of_codes();
std::vector<FormKey> comparison_members();

}  // namespace rehearse::tool
