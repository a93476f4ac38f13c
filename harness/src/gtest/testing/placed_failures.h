// Failures by exceptions, printed with their place. Internal.
#pragma once

#include <gtest/gtest.h>

#include <memory>

namespace rehearse::internal {

/// The failure of an exception whose text begins with a line of C++ (call_place.h), at that line. GoogleTest reports it
/// in an "unknown file". Others are unchanged.
::testing::TestPartResult at_its_place(const ::testing::TestPartResult& result);

/// Hands all events to a printer of GoogleTest, and failures at their place.
class PlacedFailures : public ::testing::TestEventListener {
 public:
  explicit PlacedFailures(::testing::TestEventListener* printer) : printer_(printer) {}

  void OnTestProgramStart(const ::testing::UnitTest& all) override { printer_->OnTestProgramStart(all); }
  void OnTestIterationStart(const ::testing::UnitTest& all, int i) override { printer_->OnTestIterationStart(all, i); }
  void OnEnvironmentsSetUpStart(const ::testing::UnitTest& all) override { printer_->OnEnvironmentsSetUpStart(all); }
  void OnEnvironmentsSetUpEnd(const ::testing::UnitTest& all) override { printer_->OnEnvironmentsSetUpEnd(all); }
  void OnTestSuiteStart(const ::testing::TestSuite& suite) override { printer_->OnTestSuiteStart(suite); }
  void OnTestStart(const ::testing::TestInfo& test) override { printer_->OnTestStart(test); }
  void OnTestPartResult(const ::testing::TestPartResult& result) override {
    printer_->OnTestPartResult(at_its_place(result));
  }
  void OnTestEnd(const ::testing::TestInfo& test) override { printer_->OnTestEnd(test); }
  void OnTestSuiteEnd(const ::testing::TestSuite& suite) override { printer_->OnTestSuiteEnd(suite); }
  void OnEnvironmentsTearDownStart(const ::testing::UnitTest& all) override {
    printer_->OnEnvironmentsTearDownStart(all);
  }
  void OnEnvironmentsTearDownEnd(const ::testing::UnitTest& all) override { printer_->OnEnvironmentsTearDownEnd(all); }
  void OnTestIterationEnd(const ::testing::UnitTest& all, int i) override { printer_->OnTestIterationEnd(all, i); }
  void OnTestProgramEnd(const ::testing::UnitTest& all) override { printer_->OnTestProgramEnd(all); }

 private:
  const std::unique_ptr<::testing::TestEventListener> printer_;
};

}  // namespace rehearse::internal
