// gtest prints a parameter of a test by its name, which ctest shows beside the test; else it prints the bytes.
#pragma once

#include <gtest/gtest.h>

#include <concepts>
#include <ostream>
#include <string>
#include <string_view>

namespace rehearse::test {

template <class T>
concept HasOperator = requires(std::ostream& stream, const T& value) {
  stream << value;
};
template <class T>
concept HasName = !HasOperator<T> && requires(const T& value) {
  { value.name } -> std::convertible_to<std::string_view>;
};
/// Parameters that stand for a file.
template <class T>
concept HasFile = !HasOperator<T> && !HasName<T> && requires(const T& value) {
  { value.file } -> std::convertible_to<std::string_view>;
};

/// For INSTANTIATE_TEST_SUITE_P: a test is called as its parameter.
inline constexpr auto by_name = [](const auto& test) { return std::string(test.param.name); };

}  // namespace rehearse::test

namespace testing::internal {

template <rehearse::test::HasName T>
class UniversalPrinter<T> {
 public:
  static void Print(const T& value, std::ostream* stream) { *stream << value.name; }
};

template <rehearse::test::HasFile T>
class UniversalPrinter<T> {
 public:
  static void Print(const T& value, std::ostream* stream) { *stream << value.file; }
};

}  // namespace testing::internal
