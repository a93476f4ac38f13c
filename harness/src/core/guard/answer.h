// Answers: values that a process passes to another process of the same program, as bytes.
//
// A struct is passed by its members: a function each_member(value, each) in its namespace calls `each` for every one.
#pragma once

#include <rehearse/cdr.h>
#include <rehearse/diagnostic.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace rehearse {

namespace detail {
template <class T>
inline constexpr bool is_optional = false;
template <class T>
inline constexpr bool is_optional<std::optional<T>> = true;
template <class T>
inline constexpr bool is_vector = false;
template <class T>
inline constexpr bool is_vector<std::vector<T>> = true;
template <class T>
inline constexpr bool is_pair = false;
template <class A, class B>
inline constexpr bool is_pair<std::pair<A, B>> = true;
template <class T>
inline constexpr bool is_map = false;
template <class Key, class T>
inline constexpr bool is_map<std::map<Key, T>> = true;
}  // namespace detail

/// For the parameter of each_member(): a struct that is written, or read.
template <class Value, class Struct>
concept Passed = std::is_same_v<std::remove_const_t<Value>, Struct>;

// The members are bound by structured bindings, so that a struct with one more doesn't compile here: its value would be
// lost between two processes.

void each_member(Passed<Diagnostic> auto& value, auto& each) {
  auto& [severity, file, line, column, message, hint] = value;
  each(severity), each(file), each(line), each(column), each(message), each(hint);
}

class AnswerWriter {
 public:
  template <class Value>
  void operator()(const Value& value) {
    if constexpr (CdrNumber<Value>) {
      form_.put(value);
    } else if constexpr (std::is_enum_v<Value>) {
      form_.put(static_cast<std::int32_t>(value));
    } else if constexpr (std::is_convertible_v<const Value&, std::string_view>) {
      form_.put(std::string_view(value));
    } else if constexpr (std::is_same_v<Value, std::filesystem::path>) {
      form_.put(std::string_view(value.native()));
    } else if constexpr (detail::is_optional<Value>) {
      form_.put(value.has_value());
      if (value) (*this)(*value);
    } else if constexpr (detail::is_vector<Value> || detail::is_map<Value>) {
      form_.put(static_cast<std::uint64_t>(value.size()));
      for (const auto& one : value) (*this)(one);
    } else if constexpr (detail::is_pair<Value>) {
      (*this)(value.first);
      (*this)(value.second);
    } else {
      each_member(value, *this);
    }
  }
  std::string text() const { return {reinterpret_cast<const char*>(form_.bytes().data()), form_.bytes().size()}; }

 private:
  CdrWriter form_;
};

class AnswerReader {
 public:
  /// `text` has to outlive the reader.
  explicit AnswerReader(std::string_view text) : form_(std::as_bytes(std::span(text))) {}

  template <class Value>
  void operator()(Value& value) {
    if constexpr (CdrNumber<Value>) {
      value = form_.get<Value>();
    } else if constexpr (std::is_enum_v<Value>) {
      value = static_cast<Value>(form_.get<std::int32_t>());
    } else if constexpr (std::is_same_v<Value, std::string>) {
      value = form_.get_string();
    } else if constexpr (std::is_same_v<Value, std::filesystem::path>) {
      value = std::string(form_.get_string());
    } else if constexpr (detail::is_optional<Value>) {
      value.reset();
      if (form_.get<bool>()) (*this)(value.emplace(typename Value::value_type{}));
    } else if constexpr (detail::is_vector<Value>) {
      value.clear();
      for (auto left = form_.get<std::uint64_t>(); left > 0 && form_.ok(); --left) (*this)(value.emplace_back());
    } else if constexpr (detail::is_map<Value>) {
      value.clear();
      for (auto left = form_.get<std::uint64_t>(); left > 0 && form_.ok(); --left) {
        typename Value::key_type key;
        (*this)(key);
        (*this)(value[std::move(key)]);
      }
    } else if constexpr (detail::is_pair<Value>) {
      (*this)(value.first);
      (*this)(value.second);
    } else {
      each_member(value, *this);
    }
  }
  /// Nothing was missing, and nothing is left.
  bool is_whole() const { return form_.ok() && form_.left() == 0; }

 private:
  CdrReader form_;
};

/// The bytes of a value.
template <class Value>
std::string packed(const Value& value) {
  AnswerWriter form;
  form(value);
  return form.text();
}

/// False: the bytes aren't those of such a value.
template <class Value>
bool unpack(std::string_view text, Value& value) {
  AnswerReader form(text);
  form(value);
  return form.is_whole();
}

/// The bytes of a result: its diagnostics, and the outcome if there are none.
template <class Outcome>
std::string packed_result(const Result<Outcome>& result) {
  AnswerWriter form;
  form(result ? Diagnostics() : result.errors());
  if (result) form(*result);
  return form.text();
}

template <class Outcome>
Result<Outcome> unpacked_result(std::string_view text) {
  AnswerReader form(text);
  Diagnostics errors;
  form(errors);
  if (!errors.empty()) return errors;
  Outcome outcome;
  form(outcome);
  if (!form.is_whole()) return error("the process of a run passed a damaged result");
  return outcome;
}

}  // namespace rehearse
