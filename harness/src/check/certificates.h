// Certificates: files which state that a golden passed a test under some facts. A test whose golden and facts are
// certified need not be repeated. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>
#include <string>
#include <vector>

namespace rehearse {

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

}  // namespace rehearse
