// EXPECT_SAME_IN_ALL_ORDERS, without GoogleTest.
#include <fmt/format.h>
#include <rehearse/golden.h>
#include <rehearse/gtest.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "core/guard/child_process.h"
#include "core/guard/own_library.h"
#include "test_recordings.h"
#include "test_reports.h"

namespace rehearse::internal {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// The program of audits, in the build or the installation of the libraries.
Result<fs::path> audit_program() {
  std::error_code ignored;
  for (fs::path folder = own_library_folder(); folder.has_relative_path(); folder = folder.parent_path())
    if (const fs::path program = folder / "libexec/rehearse/rehearse-audit"; fs::exists(program, ignored))
      return program;
  return error(
      fmt::format("rehearse-audit, which tries the orders, isn't installed with {}", own_library_folder().string()),
      "build Rehearse with its wing `audit`");
}

/// The report of `rehearse audit GOLDEN --orders N`.
Result<Json> audit_orders(const fs::path& golden, int orders, const fs::path& order_file) {
  const auto program = REHEARSE_TRY(audit_program());
  ChildProcess audit{{program.string(), "audit", golden.string(), "--orders", std::to_string(orders), "--json", "-o",
                      order_file.string()},
                     environment_with({})};
  audit.errors = ChildProcess::Errors::shown;
  const auto output = REHEARSE_TRY(output_of(std::move(audit)));
  Json report = Json::parse(output.text, nullptr, false);
  if (report.is_discarded() || !report.contains("orders"))
    return error(fmt::format("the orders of {} weren't tried: its audit ended with status {}", golden.string(),
                             output.status.value_or(-1)));
  return report;
}

/// `order_file`: exists only if an order matters.
TestVerdict judge(const Json& report, const fs::path& golden, const fs::path& order_file) {
  std::string verdict = report.at("verdict");
  const bool is_same = report.at("deterministic"), is_compared = report.at("orders").at("tried") > 0;
  if (fs::exists(order_file))
    verdict +=
        fmt::format("\n  it is repeated by: rehearse replay {} --order {}", golden.string(), order_file.string());
  if (is_same && !is_compared) verdict = "nothing was compared: " + verdict;
  return {is_same && is_compared, verdict};
}

}  // namespace

TestVerdict try_orders_of_golden(const std::string& name, int orders, const std::string& test) {
  if (orders < 1) return {false, fmt::format("EXPECT_SAME_IN_ALL_ORDERS tries at least one order, not {}", orders)};
  const GoldenStore store = golden_store();
  const fs::path golden = store.trace_file(name);
  report_golden_owner(store, name, "EXPECT_SAME_IN_ALL_ORDERS");
  if (!store.has(name))
    return {false, fmt::format("there is no golden {}; the run of a test becomes one: EXPECT_MATCHES_GOLDEN",
                               golden.string())};
  std::error_code ignored;
  fs::create_directories(traces_folder(), ignored);
  const fs::path order_file = fs::absolute(traces_folder() / (test + ".order.json"));
  fs::remove(order_file, ignored);
  const auto report = audit_orders(fs::absolute(golden), orders, order_file);
  TestVerdict verdict = report ? judge(*report, golden, order_file) : TestVerdict{false, to_string(report.errors())};
  TestResult result;
  result.test = test;
  result.kind = "orders";
  result.state = verdict.passed ? TestResult::State::passed : TestResult::State::failed;
  result.verdict = verdict.message.substr(0, verdict.message.find('\n'));
  const std::string told = keep_test_result(std::move(result), nullptr, {});
  if (!verdict.passed) verdict.message += told;
  return verdict;
}

}  // namespace rehearse::internal
