// Damage that was found so far. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <string>

namespace rehearse::mcap {

/// A bounded list, so that a file full of damage doesn't fill the memory with it.
class DamageLog {
 public:
  explicit DamageLog(std::string file) : file_(std::move(file)) {}
  void add(std::string message);
  /// What another log has found.
  void add(const DamageLog& other);
  const Diagnostics& list() const { return list_; }

 private:
  static constexpr std::size_t limit = 50;
  std::string file_;
  Diagnostics list_;
};

}  // namespace rehearse::mcap
