// DeclaredSource: parses the expressions of a scenario before there is a recording. Names of joints, links and limits
// are those of its models; any name is taken for that of a series. Internal.
#pragma once

#include <rehearse/scenario.h>

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/expression/expression.h"

namespace rehearse {

class DeclaredSource final : public ExpressionSource {
 public:
  /// A scenario without bodies accepts all names of joints and links, and has no limits.
  explicit DeclaredSource(const Scenario& scenario);

  /// Patterns of the series that were asked for.
  const std::vector<std::string>& names() const { return patterns_; }
  const std::map<std::string, Expectation::Limit>& limits() const { return limits_; }

  Result<std::size_t> find_series(std::string_view name) override;
  Result<std::vector<std::size_t>> find_links(std::string_view name) override;
  Result<std::size_t> find_joint_series(std::string_view joint, std::string_view quantity, bool of_command) override;
  Result<JointLimit> find_limit(std::string_view joint, std::string_view limit) override;

  double time_at(std::int64_t) const override { return 0.0; }
  double value(std::size_t, std::int64_t, CommandSide) override { return 0.0; }
  bool touching(const std::vector<std::size_t>&, const std::vector<std::size_t>&, std::int64_t) override {
    return false;
  }

 private:
  const Scenario& scenario_;
  std::vector<std::string> joints_, links_;
  std::vector<std::string> patterns_;
  std::map<std::string, Expectation::Limit> limits_;
};

/// A mistake in one of an expectation's expressions.
struct ExpressionMistake {
  std::string Expectation::*which = nullptr;  // expression, after or except
  Diagnostic diagnostic;                      // its column is that in the expression
};

/// Parses the expressions of an expectation, and sets the names and limits that they name. Returns the mistakes.
std::vector<ExpressionMistake> declare_expressions(const Scenario& scenario, Expectation& expectation);

/// A mistake in an expression with its place in a file, and the expression with a caret below its message.
Diagnostic in_expression(const Diagnostic& mistake, const std::string& expression, const Place& place, bool in_quotes);

}  // namespace rehearse
