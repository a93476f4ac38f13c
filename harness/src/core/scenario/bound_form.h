// Forms whose keys are bound to members of a struct. A key has the type of its member, and the default of the member in
// a struct that nobody changed. One loop reads all bound keys.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "scenario_values.h"

namespace rehearse {

/// A key that must be stated. `what` describes the expected value in messages; empty: the key is optional.
struct Demand {
  std::string_view what;
};

/// The type of a key whose number or numbers are read into a `Value`.
template <class Value>
ValueType bound_type(const Range& range) {
  constexpr bool is_whole =
      std::is_same_v<Value, int> || std::is_same_v<Value, std::optional<int>> || std::is_same_v<Value, std::uint32_t>;
  constexpr bool is_vector = std::is_same_v<Value, Eigen::Vector3d> || std::is_same_v<Value, Eigen::Vector3f>;
  if constexpr (is_whole) return types::whole(range.low, range.high);
  if constexpr (is_vector) return types::vector3(range);
  return types::number(range);
}

/// A row of a bound form. A member is a pointer to a member of `Settings`, or a function that returns a reference to a
/// part of `Settings`.
template <class Settings>
struct BoundKey {
  template <class Member>
  using Value = std::remove_cvref_t<std::invoke_result_t<const Member&, Settings&>>;

  FormKey row;
  std::function<void(const Keys&, Settings&)> read;  // empty: the key has a reader of its own

  /// A key with a reader of its own.
  BoundKey(FormKey key) : row(std::move(key)) {}

  /// A value of a type that the member can have: with units, or text of a certain form.
  template <class Member>
  BoundKey(std::string_view name, Member member, const ValueType& type, std::string_view text, Demand demand = {})
      : BoundKey(FormKey{name, type, text, fallback_of(type, member, demand)}, demand,
                 [=](const Keys& keys, Settings& settings) { keys.read(name, std::invoke(member, settings)); }) {}

  /// A number or three numbers.
  template <class Member>
  BoundKey(std::string_view name, Member member, const Range& range, std::string_view text, Demand demand = {})
      : BoundKey(name, member, bound_type<Value<Member>>(range), text, demand) {}

  /// A flag, or any text.
  template <class Member>
  BoundKey(std::string_view name, Member member, std::string_view text)
      : BoundKey(name, member, std::is_same_v<Value<Member>, std::string> ? types::text() : types::flag(), text) {}

  /// One of some words.
  template <class Member>
  BoundKey(std::string_view name, Member member, Words<Value<Member>> words, std::string_view text, Demand demand = {})
      : BoundKey(FormKey{name, types::word(words.names()), text,
                         demand.what.empty() ? words.name_of(default_of(member)) : std::string(required)},
                 demand,
                 [=](const Keys& keys, Settings& settings) { keys.read(name, words, std::invoke(member, settings)); }) {
  }

 private:
  BoundKey(FormKey key, Demand demand, std::function<void(const Keys&, Settings&)> read_stated)
      : row(std::move(key)), read(std::move(read_stated)) {
    if (!demand.what.empty())
      read = [name = row.name, demand, stated = std::move(read)](const Keys& keys, Settings& settings) {
        if (keys.require(name, demand.what) != nullptr) stated(keys, settings);
      };
  }

  template <class Member>
  static Value<Member> default_of(const Member& member) {
    Settings settings{};
    return std::invoke(member, settings);
  }

  template <class Member>
  static std::string fallback_of(const ValueType& type, const Member& member, Demand demand) {
    return demand.what.empty() ? one_text(written_default(type, default_of(member))) : std::string(required);
  }
};

template <class Settings>
class BoundForm : public Form {
 public:
  using Groups = std::vector<std::vector<std::string_view>>;

  BoundForm(std::string_view name, std::string_view owner, std::vector<BoundKey<Settings>> rows, Groups needed = {},
            Groups one_of = {})
      : Form{name, owner, {}, std::move(needed), std::move(one_of)} {
    for (BoundKey<Settings>& each : rows) {
      keys.push_back(std::move(each.row));
      if (each.read) readers_.push_back(std::move(each.read));
    }
  }

  /// Reads all bound keys into their members. The member of a missing or wrong key keeps its value.
  void read(const Keys& map, Settings& settings) const {
    for (const auto& read_one : readers_) read_one(map, settings);
  }

 private:
  std::vector<std::function<void(const Keys&, Settings&)>> readers_;
};

}  // namespace rehearse
