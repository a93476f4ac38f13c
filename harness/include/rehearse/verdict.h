// A verdict: statements in their order, each with its code. The sentence, the codes, JUnit and the report are made from
// them.
#pragma once

#include <rehearse/verdict_code.h>

#include <string>
#include <utility>
#include <vector>

namespace rehearse {

/// A statement of a verdict.
struct VerdictPart {
  VerdictCode code;
  std::string sentence;  // without a full stop; empty: another statement contains it
};

class Verdict {
 public:
  Verdict() = default;
  Verdict(VerdictCode code, std::string sentence) { add(code, std::move(sentence)); }

  /// Puts a statement before the others.
  void lead(VerdictCode code, std::string sentence = {});
  /// Puts a statement after the others.
  void add(VerdictCode code, std::string sentence = {});
  /// Puts these statements after the others.
  void add(const Verdict& others);

  bool empty() const { return parts_.empty(); }
  const std::vector<VerdictPart>& parts() const { return parts_; }

  /// One sentence, without a full stop: the statements, separated by semicolons.
  std::string text() const;
  /// text() without the statements that have one of these codes.
  std::string text_without(const std::vector<VerdictCode>& codes) const;
  /// In the order of the statements; the first one is the code of the whole.
  std::vector<VerdictCode> codes() const;
  /// "controller.changed": the name of the first code; empty without a statement.
  std::string code() const;

 private:
  std::vector<VerdictPart> parts_;
};

}  // namespace rehearse
