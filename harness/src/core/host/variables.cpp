#include "variables.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <utility>

#include "base/text.h"
#include "core/guard/cost_counter.h"

namespace rehearse {
namespace {

thread_local ControllerVariables* open_variables = nullptr;
std::atomic<bool> strayed{false};

}  // namespace

ControllerVariables::Open::Open(ControllerVariables* variables) { open_variables = variables; }
ControllerVariables::Open::~Open() { open_variables = nullptr; }

bool ControllerVariables::take_strays() { return strayed.exchange(false); }

const ControllerVariables::Variable* ControllerVariables::find(std::string_view name) const {
  const auto found = by_name_.find(name);
  return found == by_name_.end() ? nullptr : &all_[found->second];
}

void ControllerVariables::begin_tick() {
  for (Variable& variable : all_) variable.is_set = false;
  next_ = 0;
}

void ControllerVariables::set(const char* name, double value) {
  if (!name) return refuse(Mistake::no_name, "");
  std::size_t place = next_;
  if (place >= all_.size() || all_[place].name != name) {
    const Mistake mistake = mistake_in(name);
    if (mistake != Mistake::none) return refuse(mistake, name);
    const auto [known, is_new] = by_name_.emplace(name, all_.size());
    place = known->second;
    if (is_new) all_.push_back({name});
  }
  all_[place].value = value;
  all_[place].is_set = true;
  next_ = place + 1;
}

ControllerVariables::Mistake ControllerVariables::mistake_in(const char* name) const {
  const std::string_view text(name, strnlen(name, longest_name + 1));
  if (text.empty()) return Mistake::no_name;
  if (text.size() > longest_name) return Mistake::too_long;
  if (!is_utf8(text)) return Mistake::not_text;
  return all_.size() < most || by_name_.contains(text) ? Mistake::none : Mistake::too_many;
}

void ControllerVariables::refuse(Mistake mistake, const char* name) {
  if (std::ranges::find(told_, mistake) != told_.end()) return;
  told_.push_back(mistake);
  switch (mistake) {
    case Mistake::none: break;
    case Mistake::no_name: findings_.push_back("set a variable without a name: it isn't recorded"); break;
    case Mistake::too_long:
      findings_.push_back(
          fmt::format("set a variable whose name begins with '{}' and has more than {} bytes: it isn't "
                      "recorded",
                      is_utf8({name, 20}) ? std::string(name, 20) : "...", longest_name));
      break;
    case Mistake::not_text: findings_.push_back("set a variable whose name isn't UTF-8: it isn't recorded"); break;
    case Mistake::too_many:
      findings_.push_back(
          fmt::format("set more than {} variables: '{}' and those that come after it aren't recorded", most, name));
      break;
  }
}

std::vector<std::string> ControllerVariables::take_findings() { return std::exchange(findings_, {}); }

}  // namespace rehearse

/// The function that rehearse_variable() calls if this library is loaded.
extern "C" __attribute__((visibility("default"))) void rehearse_record_variable(const char* name, double value);

void rehearse_record_variable(const char* name, double value) {
  const rehearse::HostCode own;
  if (rehearse::open_variables)
    rehearse::open_variables->set(name, value);
  else
    rehearse::strayed = true;
}
