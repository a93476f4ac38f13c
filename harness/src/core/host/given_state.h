// GivenState: the numbers that controllers take by rehearse_state() (controllers/include/rehearse_state.h).
//
// This file defines that function for all libraries that are loaded after this one. Without a GivenState in the thread
// that calls a controller the function gives nothing.
#pragma once

#include <map>
#include <string>

namespace rehearse {

class GivenState {
 public:
  /// During its lifetime controllers that this thread calls get these numbers, by name. They don't nest.
  explicit GivenState(std::map<std::string, double> numbers = {});
  ~GivenState();
  GivenState(const GivenState&) = delete;
  GivenState& operator=(const GivenState&) = delete;

  /// False: there is no number of that name.
  bool take(const char* name, double* value);
  /// The numbers that controllers asked for, by name, where they keep them.
  const std::map<std::string, double*>& asked() const { return asked_; }

 private:
  std::map<std::string, double> numbers_;
  std::map<std::string, double*> asked_;
};

}  // namespace rehearse
