#include "form.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {

using Kind = ValueType::Kind;

bool Range::contains(double value) const {
  return (open_low ? value > low : value >= low) && (open_high ? value < high : value <= high);
}

std::string Range::text() const {
  const std::string limits = open_low || open_high ? fmt::format("{} {} and {} {}", open_low ? "above" : "at least",
                                                                 low, open_high ? "below" : "at most", high)
                                                   : fmt::format("from {} to {}", low, high);
  return unit.empty() ? limits : fmt::format("{} {}", limits, unit);
}

const FormKey* Form::find(std::string_view key) const {
  const auto found = std::ranges::find_if(keys, [&](const FormKey& each) { return each.name == key; });
  return found == keys.end() ? nullptr : &*found;
}

std::vector<std::string_view> Form::key_names() const {
  std::vector<std::string_view> names;
  for (const FormKey& key : keys) names.push_back(key.name);
  return names;
}

namespace types {
namespace {

ValueType of_kind(Kind kind) {
  ValueType type{};
  type.kind = kind;
  return type;
}

}  // namespace

ValueType text() { return of_kind(Kind::text); }
ValueType some_text() { return text_like("."); }
ValueType name() { return text_like("^[^ \\t/*?\\[\\]]{1,100}$"); }
ValueType flag() { return of_kind(Kind::flag); }
ValueType empty() { return of_kind(Kind::empty); }
ValueType string() { return of_kind(Kind::string); }
ValueType real() { return of_kind(Kind::real); }
ValueType any() { return of_kind(Kind::any); }

ValueType text_like(std::string expression) {
  ValueType type = of_kind(Kind::text);
  type.words = {std::move(expression)};
  return type;
}

ValueType number(const Range& range) {
  ValueType type = of_kind(Kind::number);
  type.range = range;
  return type;
}

ValueType whole(double low, double high) {
  ValueType type = of_kind(Kind::whole);
  type.range = {low, high};
  return type;
}

ValueType count() { return whole(0.0, std::numeric_limits<double>::infinity()); }

ValueType word(std::vector<std::string> words) {
  ValueType type = of_kind(Kind::word);
  type.words = std::move(words);
  return type;
}

ValueType quantity(std::span<const Unit> units, const Range& range) {
  ValueType type = of_kind(Kind::quantity);
  type.units = units;
  type.range = range;
  return type;
}

ValueType matching(std::string expression) {
  ValueType type = of_kind(Kind::matching);
  type.words = {std::move(expression)};
  return type;
}

ValueType list(ValueType element, std::size_t least, std::size_t most) {
  ValueType type = of_kind(Kind::list);
  type.parts = {std::move(element)};
  type.least = least;
  type.most = most;
  return type;
}

ValueType array(ValueType element) { return list(std::move(element), 0, std::numeric_limits<std::size_t>::max()); }

ValueType map(ValueType value, std::vector<std::string> names) {
  ValueType type = of_kind(Kind::map);
  type.parts = {std::move(value)};
  type.words = std::move(names);
  return type;
}

ValueType of(std::function<const Form&()> form) {
  ValueType type = of_kind(Kind::form);
  type.form = std::move(form);
  return type;
}

ValueType either(std::vector<ValueType> types) {
  ValueType type = of_kind(Kind::either);
  type.parts = std::move(types);
  return type;
}

ValueType vector3(const Range& range) { return list(number(range), 3, 3); }

ValueType nullable(ValueType type) { return either({std::move(type), empty()}); }

}  // namespace types
}  // namespace rehearse
