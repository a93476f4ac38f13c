// Inputs that a controller reads and never enabled: enableInput() was forgotten. They keep their first value.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace rehearse {

class IoBody;
struct HostedController;

/// Watches q() and dq() of the links in controllers' bodies. What is called to write isn't told from what is called to
/// read, so a state counts that was called and keeps its bits for the whole run.
class UnreadInputs {
 public:
  /// Begins with the first tick.
  void begin(const std::vector<HostedController>& controllers);
  /// A sentence for each controller and state: "Arm/Hold calls q() of joint 'SHOULDER' and never enabled that input:
  /// ...". Controllers that share a body count as their parent.
  std::vector<std::string> found(const std::vector<HostedController>& controllers) const;

 private:
  struct Watched {
    std::shared_ptr<IoBody> body;
    std::vector<double> q, dq;  // by link, at the beginning
  };
  std::vector<Watched> watched_;
};

}  // namespace rehearse
