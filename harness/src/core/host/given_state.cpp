#include "given_state.h"

#include <utility>

namespace rehearse {
namespace {

thread_local GivenState* given_state = nullptr;

}  // namespace

GivenState::GivenState(std::map<std::string, double> numbers) : numbers_(std::move(numbers)) { given_state = this; }
GivenState::~GivenState() { given_state = nullptr; }

bool GivenState::take(const char* name, double* value) {
  if (!name || !*name || !value) return false;
  asked_[name] = value;
  const auto found = numbers_.find(name);
  if (found == numbers_.end()) return false;
  *value = found->second;
  return true;
}

}  // namespace rehearse

/// The function that rehearse_state() calls if this library is loaded.
extern "C" __attribute__((visibility("default"))) int rehearse_take_state(const char* name, double* value);

int rehearse_take_state(const char* name, double* value) {
  return rehearse::given_state && rehearse::given_state->take(name, value) ? 1 : 0;
}
