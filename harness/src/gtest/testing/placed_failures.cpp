#include "placed_failures.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>
#include <string_view>

namespace rehearse::internal {
namespace {

constexpr std::string_view of_exception = "C++ exception with description \"";

/// True for the name of a source or header of C++.
bool is_source(std::string_view file) {
  constexpr std::array<std::string_view, 9> ends{".cpp", ".cc", ".cxx", ".c++", ".C", ".h", ".hpp", ".hh", ".hxx"};
  return std::ranges::any_of(ends, [&](std::string_view end) {
    return file.size() > end.size() && file.substr(file.size() - end.size()) == end;
  });
}

}  // namespace

::testing::TestPartResult at_its_place(const ::testing::TestPartResult& result) {
  const std::string_view text = result.message();
  if (result.file_name() || text.substr(0, of_exception.size()) != of_exception) return result;
  const std::string_view said = text.substr(of_exception.size());
  const std::size_t line = said.find(':');
  const std::size_t message = said.find(": ", line == std::string_view::npos ? line : line + 1);
  if (message == std::string_view::npos || !is_source(said.substr(0, line))) return result;
  const std::string file(said.substr(0, line)), number(said.substr(line + 1, message - line - 1));
  if (number.empty() || number.find_first_not_of("0123456789") != std::string::npos) return result;
  const std::string rest = std::string(of_exception) + std::string(said.substr(message + 2));
  return {result.type(), file.c_str(), std::atoi(number.c_str()), rest.c_str()};
}

}  // namespace rehearse::internal
