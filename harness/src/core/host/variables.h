// ControllerVariables: the numbers that a controller sets by rehearse_variable()
// (controllers/include/rehearse_variable.h) while it is called.
//
// This file defines that function for all libraries that are loaded after this one. A call into a controller opens the
// controller's ControllerVariables in the thread that makes the call, so values are stored for the right controller. A
// value that is set while none is open is a stray and isn't stored.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

class ControllerVariables {
 public:
  static constexpr std::size_t most = 1000;         // names
  static constexpr std::size_t longest_name = 200;  // [bytes]

  struct Variable {
    std::string name;
    double value = 0.0;   // the last value that was set
    bool is_set = false;  // in this tick
  };

  /// In the order in which they were first set.
  const std::vector<Variable>& all() const { return all_; }
  /// Null if it was never set.
  const Variable* find(std::string_view name) const;
  /// Begins a tick in which no variable is set so far.
  void begin_tick();
  /// Stores the value; an invalid one becomes a finding.
  void set(const char* name, double value);
  /// Findings since the last call, each kind once: a description of the controller's mistake, without its name.
  std::vector<std::string> take_findings();

  /// Values that this thread sets during its lifetime are stored in `variables`; null: they are dropped. They don't
  /// nest.
  class Open {
   public:
    explicit Open(ControllerVariables* variables);
    ~Open();
    Open(const Open&) = delete;
    Open& operator=(const Open&) = delete;
  };
  /// True if a variable was set while none was open, since the last call.
  static bool take_strays();

 private:
  enum class Mistake { none, no_name, too_long, not_text, too_many };
  Mistake mistake_in(const char* name) const;
  void refuse(Mistake mistake, const char* name);

  std::vector<Variable> all_;
  std::map<std::string, std::size_t, std::less<>> by_name_;
  std::size_t next_ = 0;  // the variable that is probably set next
  std::vector<std::string> findings_;
  std::vector<Mistake> told_;
};

}  // namespace rehearse
