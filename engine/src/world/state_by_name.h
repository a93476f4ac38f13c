// The state of a world by the names of bodies and owners. Private to the world library.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "simulated_body.h"

namespace rehearse {

/// Reads the state of a world and stores its parts by name.
class StateByName final : public StateVisitor {
 public:
  using Name = std::tuple<std::string, std::string, StatePart>;  // body, owner, part

  /// The bytes of a part; null if the part is missing.
  const std::vector<std::byte>* find(const Name& name) const;
  bool has_body(const std::string& body) const;

 private:
  void enter(const std::string& body, const std::string& owner, StatePart part) override;
  void take(void* data, std::size_t size) override;

  std::map<Name, std::vector<std::byte>> parts_;
  std::vector<std::byte>* current_ = nullptr;
};

/// Writes the state into another world. A part that is missing in the state, or has a different size there, stays
/// unchanged.
class StateTaker final : public StateVisitor {
 public:
  explicit StateTaker(StateByName state) : state_(std::move(state)) {}

  /// Errors about missing parts on which the next step depends: one for each body, link or joint.
  const Diagnostics& missing();

 private:
  void enter(const std::string& body, const std::string& owner, StatePart part) override;
  void take(void* data, std::size_t size) override;
  void end_part();

  StateByName state_;
  StateByName::Name name_{"", "", StatePart::clock};  // of the current part
  const std::vector<std::byte>* current_ = nullptr;
  std::size_t at_ = 0;  // bytes of the current part visited so far
  std::set<std::string> told_;
  Diagnostics missing_;
};

}  // namespace rehearse
