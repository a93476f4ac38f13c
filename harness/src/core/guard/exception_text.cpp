#include "exception_text.h"

#include <cxxabi.h>
#include <rehearse/c_controller.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <typeinfo>

#include "base/text.h"

namespace rehearse {
namespace {

constexpr std::size_t longest_text = 200;  // [bytes]

std::string demangled(const char* name) {
  int status = 0;
  char* text = abi::__cxa_demangle(name, nullptr, nullptr, &status);
  std::string result = status == 0 && text ? text : name;
  std::free(text);
  return result;
}

}  // namespace

std::string text_of_controller(std::string_view text) {
  while (text.ends_with('\n')) text.remove_suffix(1);
  std::string shown;
  while (!text.empty()) {
    if (shown.size() >= longest_text) return shown + "...";
    const std::size_t length = std::max<std::size_t>(utf8_length(text), 1);
    shown += text.front() == '\n' ? " | " : plain_text(text.substr(0, length));
    text.remove_prefix(length);
  }
  return shown;
}

std::string describe_exception() {
  try {
    throw;
  } catch (const ReportedFailure& failure) {
    return text_of_controller(failure.what());
  } catch (const std::exception& exception) {
    return "threw " + text_of_controller(demangled(typeid(exception).name())) + ": " +
           text_of_controller(exception.what());
  } catch (...) {
    const std::type_info* const type = abi::__cxa_current_exception_type();
    return "threw something that is no std::exception" +
           (type ? ": " + text_of_controller(demangled(type->name())) : std::string());
  }
}

std::string describe_termination() {
  if (!std::current_exception())
    return "crashed: it called abort by std::terminate(), as the destructor of a running std::thread does";
  return "crashed: it called abort, as it " + describe_exception() + " (out of a function that may not throw)";
}

}  // namespace rehearse
