// Descriptions of the maps in files and of the objects in JSON: their keys with types, defaults and texts. Parsers,
// the reference of keys and JSON Schemas are made of them.
#pragma once

#include <rehearse/units.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "value_range.h"

namespace rehearse {

struct Form;

/// The values that a key accepts.
struct ValueType {
  enum class Kind : std::uint8_t {
    text,      // any scalar of YAML; if `words` isn't empty, it matches the regular expression `words[0]`
    number,    // finite
    whole,     // a whole number
    flag,      // true or false
    word,      // one of `words`
    quantity,  // a number, or one with one of `units`
    matching,  // text that matches the regular expression `words[0]`
    list,      // `least` to `most` values of the type `parts[0]`
    map,       // from any name, or from one of `words`, to the type `parts[0]`
    form,      // a map with the keys of `form`
    either,    // one of the types `parts`
    empty,     // no value; null in JSON
    string,    // of JSON
    real,      // of JSON: a number, or "NaN", "Infinity", "-Infinity"
    any,       // of JSON
  };
  Kind kind;
  Range range{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  std::vector<std::string> words{};
  std::span<const Spelling> units{};
  std::vector<ValueType> parts{};
  std::size_t least = 0;
  std::size_t most = std::numeric_limits<std::size_t>::max();
  std::function<const Form&()> form{};
};

/// A key of a map.
struct FormKey {
  std::string_view name;
  ValueType type;
  std::string_view text;
  /// The default as it would be written; `required`; empty: there is none, or it depends on other values.
  std::string fallback{};
};
inline constexpr const char* required = "required";

/// A map with a fixed set of keys.
struct Form {
  std::string_view name;   // of its definition in a schema
  std::string_view owner;  // the described object, with its article: "a body"
  std::vector<FormKey> keys;
  std::vector<std::vector<std::string_view>> needed{};  // of each group at least one key is stated
  std::vector<std::vector<std::string_view>> one_of{};  // of each group exactly one key is stated

  /// Null: there is no such key.
  const FormKey* find(std::string_view key) const;
  std::vector<std::string_view> key_names() const;
};

/// Types of values in files.
namespace types {
ValueType text();
/// Text that matches a regular expression.
ValueType text_like(std::string expression);
/// Text that isn't empty.
ValueType some_text();
/// A name that is valid in a channel name.
ValueType name();
ValueType number(const Range& range);
ValueType whole(double low, double high);
ValueType flag();
ValueType word(std::vector<std::string> words);
ValueType quantity(std::span<const Spelling> units, const Range& range);
/// Text that matches a regular expression as a whole.
ValueType matching(std::string expression);
ValueType list(ValueType element, std::size_t least = 0, std::size_t most = 1000);
ValueType map(ValueType value, std::vector<std::string> names = {});
ValueType of(std::function<const Form&()> form);
ValueType either(std::vector<ValueType> types);
ValueType empty();
/// [x, y, z]
ValueType vector3(const Range& range);

// Of JSON that programs write.
ValueType string();
ValueType real();
ValueType count();
ValueType any();
ValueType array(ValueType element);
ValueType nullable(ValueType type);
}  // namespace types

}  // namespace rehearse
