// Proof: whether the physics of a golden need not be simulated again.
//
// A check that simulates the closed loop and gets the golden, bit for bit, shows that this world, under the golden's
// commands, makes the golden. It stores this as a file: a certificate for the golden's bytes and for all facts on which
// the world's bits depend (session.h: describe_plant). With a certificate, the plant level needs no simulation. If the
// controllers also repeat the golden's commands on its inputs, the closed loop is the golden by induction over the
// ticks: equal commands make equal inputs, and equal inputs make equal commands.
#pragma once

#include <rehearse/check.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {

/// Files which state that a golden passed a test under some facts. A test whose golden and facts are certified need not
/// be repeated.
class Certificates {
 public:
  /// `subject`: the test and the hash of the golden's bytes, as a part of a file name.
  Certificates(std::filesystem::path folder, std::string subject)
      : folder_(std::move(folder)), subject_(std::move(subject)) {}

  /// `facts`: lines "name: value".
  bool has(const std::string& facts) const;
  /// Other processes never read a partial certificate. Fails if the file can't be written.
  Result<void> add(const std::string& facts) const;
  /// The facts of all certificates of the subject.
  std::vector<std::string> all() const;

 private:
  std::filesystem::path file_for(const std::string& facts) const;

  std::filesystem::path folder_;
  std::string subject_;
};

class Proof {
 public:
  /// Searches the certificate. `golden`: without messages.
  Proof(const Scenario& scenario, const Trace& golden, const CheckOptions& options, const Simulation& simulation);

  /// True if a certificate states that the world makes the golden under the golden's commands.
  bool holds() const { return holds_; }
  /// A sentence: the reason why there is no proof. Empty if there is a proof, or if none was wanted.
  const std::string& objection() const { return objection_; }
  /// The hash of the golden's bytes. There must be a proof.
  std::uint64_t golden_hash() const { return golden_; }
  /// Stores the certificate, unless the golden's file has changed. The caller has simulated the whole closed loop, and
  /// every bit was the golden's.
  Result<void> certify() const;

 private:
  std::string objection_to(const Scenario& scenario, const Trace& golden, const CheckOptions& options,
                           const Simulation& simulation);
  std::string changes() const;

  std::optional<Certificates> certificates_;
  std::filesystem::path golden_file_;
  std::uint64_t golden_ = 0;  // hash of its bytes
  std::string plant_;         // facts, a line each; empty: unknown
  bool holds_ = false;
  std::string objection_;
};

}  // namespace rehearse
