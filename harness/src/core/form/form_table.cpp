#include "form_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace rehearse {
namespace {

using Kind = ValueType::Kind;

/// "one, two or three"
std::string alternatives(const std::vector<std::string>& all) {
  std::string text;
  for (std::size_t i = 0; i < all.size(); ++i)
    text += fmt::format("{}{}", i == 0 ? "" : i + 1 == all.size() ? " or " : ", ", all[i]);
  return text;
}

std::string limits_of(const Range& range) {
  if (std::isinf(range.low) && std::isinf(range.high)) return "";
  if (range.low == -range.high && !range.open_low && !range.open_high)
    return fmt::format(" within ±{}{}{}", range.high, range.unit.empty() ? "" : " ", range.unit);
  return ' ' + range.text();
}

/// A small map by its keys, a large one by its name.
std::string form_in_words(const Form& form) {
  constexpr std::size_t most_keys = 4;
  if (form.keys.size() <= most_keys) return fmt::format("map of `{}`", fmt::join(form.key_names(), "`, `"));
  return std::string(form.owner);
}

std::string values_of(const ValueType& type);

std::string list_of(const ValueType& type) {
  const ValueType& element = type.parts[0];
  if (type.least == 0 || type.least != type.most) return "list of: " + values_of(element);
  const bool is_number = element.kind == Kind::number;
  return fmt::format("{} {}", type.least,
                     is_number ? "numbers" + limits_of(element.range) : "of: " + values_of(element));
}

std::string values_of(const ValueType& type) {
  std::vector<std::string> parts;
  switch (type.kind) {
    case Kind::text:
    case Kind::matching:
    case Kind::string: return "text";
    case Kind::number:
    case Kind::real: return "number" + limits_of(type.range);
    case Kind::whole: return fmt::format("whole number from {} to {}", type.range.low, type.range.high);
    case Kind::flag: return "`true` or `false`";
    case Kind::word:
      for (const std::string& word : type.words) parts.push_back(fmt::format("`{}`", word));
      return alternatives(parts);
    case Kind::quantity:
      for (const Spelling& unit : type.units) parts.emplace_back(unit.text);
      return fmt::format("number{}, or with {}", limits_of(type.range), alternatives(parts));
    case Kind::list: return list_of(type);
    case Kind::map: return "map of names to: " + values_of(type.parts[0]);
    case Kind::form: return form_in_words(type.form());
    case Kind::either:
      for (const ValueType& part : type.parts) parts.push_back(values_of(part));
      return alternatives(parts);
    case Kind::empty: return "nothing";
    case Kind::any: return "anything";
  }
  return "";
}

std::string escaped(std::string_view text) {
  std::string cell;
  for (const char c : text) cell += c == '|' ? "\\|" : std::string(1, c);
  return cell;
}

std::string default_of(const FormKey& key) {
  if (key.fallback.empty() || key.fallback == required) return key.fallback;
  return fmt::format("`{}`", key.fallback);
}

const Form* find_form(const ValueType& type, std::string_view name, std::vector<const Form*>& known) {
  for (const ValueType& part : type.parts)
    if (const Form* found = find_form(part, name, known)) return found;
  if (!type.form || std::ranges::find(known, &type.form()) != known.end()) return nullptr;
  known.push_back(&type.form());
  if (type.form().name == name) return &type.form();
  for (const FormKey& key : type.form().keys)
    if (const Form* found = find_form(key.type, name, known)) return found;
  return nullptr;
}

}  // namespace

std::string table_text(const Form& form) {
  std::string table = "| key | what | values | default |\n| --- | --- | --- | --- |\n";
  for (const FormKey& key : form.keys)
    table += fmt::format("| `{}` | {} | {} | {} |\n", key.name, escaped(key.text), escaped(values_of(key.type)),
                         default_of(key));
  return table;
}

const Form* find_form(const ValueType& type, std::string_view name) {
  std::vector<const Form*> known;
  return find_form(type, name, known);
}

}  // namespace rehearse
