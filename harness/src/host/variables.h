// ControllerVariables: the numbers that a controller sets by rehearse_variable()
// (controllers/include/rehearse_variable.h) while it is called.
//
// The function behind that name is defined here, for all libraries that are loaded after this one. It knows which
// controller speaks because a call into one opens its ControllerVariables, in the thread that makes the call. What
// comes where none is open is a stray, and isn't kept.
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
    double value = 0.0;   // the last one that was set
    bool is_set = false;  // in this tick
  };

  /// In the order in which they were first set.
  const std::vector<Variable>& all() const { return all_; }
  /// Null: it was never set.
  const Variable* find(std::string_view name) const;
  /// Nothing is set in the tick that begins.
  void begin_tick();
  /// Keeps the value; if it may not be, a finding.
  void set(const char* name, double value);
  /// What was refused since the last call, each kind once: what the controller did, without its name.
  std::vector<std::string> take_findings();

  /// While it lives, what is set in this thread goes into `variables`; null: nowhere. They don't nest.
  class Open {
   public:
    explicit Open(ControllerVariables* variables);
    ~Open();
    Open(const Open&) = delete;
    Open& operator=(const Open&) = delete;
  };
  /// Whether anything was set, since this was last asked, where none was open.
  static bool take_strays();

 private:
  enum class Mistake { none, no_name, too_long, not_text, too_many };
  Mistake mistake_in(const char* name) const;
  void refuse(Mistake mistake, const char* name);

  std::vector<Variable> all_;
  std::map<std::string, std::size_t, std::less<>> by_name_;
  std::size_t next_ = 0;  // nearly always the one that is set next
  std::vector<std::string> findings_;
  std::vector<Mistake> told_;
};

}  // namespace rehearse
