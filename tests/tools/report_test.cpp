// rehearse report, and the report of a failing check. The page is an empty one: no test here needs npm.
#include "command.h"

#include <gmock/gmock.h>

namespace rehearse::test {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class ReportVerb : public Command {
 protected:
  ReportVerb() {
    page_ = "REHEARSE_REPORT_PAGE=" + write("page.html", "<!doctype html><html><!-- REHEARSE DATA --></html>").string();
  }
  Outcome with_page(const std::vector<std::string>& arguments) const { return rehearse(arguments, page_); }
  void record_box(const std::string& file) const { done({"record", box_scenario.string(), "-o", file}); }

  std::string page_;
};

TEST_F(ReportVerb, WritesOneFileAndSaysWhereItOpens) {
  record_box("my box.mcap");
  const Outcome outcome = with_page({"report", "my box.mcap"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, ContainsRegex("^a run by itself: .*\nfile:///.*/my%20box.html, [0-9.]+ kB\n$"));
  EXPECT_THAT(read_file(folder() / "my box.html"), StartsWith("<!doctype html><!-- a report of Rehearse -->"));
  EXPECT_FALSE(exists("my box.html.part"));
}

TEST_F(ReportVerb, ShowsARunBesideItsGolden) {
  record_box("a.mcap");
  done({"record", box_scenario.string(), "-o", "b.mcap", "--seed", "7"});
  const nlohmann::json report = with_page({"report", "b.mcap", "a.mcap", "-o", "both.html", "--json"}).json();
  EXPECT_THAT(report["link"].get<std::string>(), ContainsRegex("^file:///.*/both.html"));
  EXPECT_EQ(report["bytes"], fs::file_size(folder() / "both.html"));
  EXPECT_EQ(report["verdict"], rehearse({"diff", "a.mcap", "b.mcap", "--json"}).json()["verdict"]);
  EXPECT_THAT(read_file(folder() / "both.html"), HasSubstr("\"role\":\"golden\""));
}

TEST_F(ReportVerb, CountsTicksAsAllVerbsDo) {
  const nlohmann::json recorded = rehearse({"record", box_scenario.string(), "-o", "box.mcap", "--json"}).json();
  with_page({"report", "box.mcap"});
  const std::int64_t ticks = recorded["ticks"];
  EXPECT_EQ(rehearse({"info", "box.mcap", "--json"}).json()["ticks"], ticks);
  const std::string report = read_file(folder() / "box.html");
  EXPECT_THAT(report, HasSubstr("\"ticks\":" + std::to_string(ticks) + ","));
  EXPECT_THAT(report, HasSubstr("\"begin\":0,\"end\":" + std::to_string(ticks + 1) + ","));  // states
}

TEST_F(ReportVerb, TakesAPart) {
  record_box("box.mcap");
  const nlohmann::json report =
      with_page({"report", "box.mcap", "--from", "0.1", "--until", "0.2", "--topics", "/Box/*", "--json"}).json();
  EXPECT_EQ(report["begin"], 100);
  EXPECT_EQ(report["end"], 200);
  EXPECT_THAT(report["omitted"].dump(), HasSubstr("not asked for"));
}

TEST_F(ReportVerb, OfACutRecordingSaysWhatIsLost) {
  record_box("box.mcap");
  fs::resize_file(folder() / "box.mcap", fs::file_size(folder() / "box.mcap") * 2 / 3);
  const Outcome outcome = with_page({"report", "box.mcap"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.err, HasSubstr("box.mcap: note: The recording is incomplete"));
}

TEST_F(ReportVerb, RefusesWhatItCanNotShow) {
  write("text.mcap", "not MCAP");
  const auto refused = [&](const std::vector<std::string>& arguments) {
    const Outcome outcome = with_page(arguments);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.out, "");
    return outcome.err;
  };
  EXPECT_THAT(refused({"report", "missing.mcap"}), HasSubstr("missing.mcap"));
  EXPECT_THAT(refused({"report", "text.mcap"}), HasSubstr("text.mcap"));
  EXPECT_FALSE(exists("text.html"));
  record_box("box.mcap");
  write("box.html", "<!doctype html><p>mine");
  EXPECT_THAT(refused({"report", "box.mcap"}), HasSubstr("won't replace box.html"));
  EXPECT_THAT(refused({"report", "box.mcap", "-o", "box.mcap"}), HasSubstr("won't replace box.mcap"));
  EXPECT_EQ(read_file(folder() / "box.html"), "<!doctype html><p>mine");
  EXPECT_THAT(refused({"report", "box.mcap", "-o", "b.html", "--from", "99"}), HasSubstr("nothing was recorded"));
  EXPECT_THAT(refused({"report", "box.mcap", "-o", "no/such/folder.html"}), HasSubstr("can't be written"));
}

class CheckReportPage : public ReportVerb {
 protected:
  /// Its golden is of another height.
  void make_repository() const {
    fs::create_directories(folder() / "golden");
    std::string text = read_file(box_scenario);
    text += "golden: Box.Falls\n";
    write("falls.yaml", text);
    rehearse({"check", "falls.yaml"}, "REHEARSE_GOLDEN=new");
    const std::size_t at = text.find("position: [0, 0, 0.6]");
    ASSERT_NE(at, std::string::npos);
    write("falls.yaml", text.replace(at, 21, "position: [0, 0, 0.7]"));
  }
};

TEST_F(CheckReportPage, IsLeftBesideARunThatDiffers) {
  make_repository();
  const Outcome outcome = with_page({"check", "falls.yaml"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, ContainsRegex("\nin a browser: file:///.*/rehearse-pending/Box.Falls.html#tick=0\n"));
  const std::string page = read_file(folder() / "rehearse-pending/Box.Falls.html");
  EXPECT_THAT(page, AllOf(HasSubstr("\"state\":\"beyond\""), HasSubstr("\"closed\":\"differs\"")));
  EXPECT_EQ(with_page({"check", "falls.yaml", "--json"}).json()["report"], "rehearse-pending/Box.Falls.html");
  done({"golden", "accept", "Box.Falls"});
  EXPECT_FALSE(exists("rehearse-pending/Box.Falls.html"));
}

TEST_F(CheckReportPage, IsNotMadeIfNobodyWantsItOrNothingDiffers) {
  make_repository();
  EXPECT_EQ(with_page({"check", "falls.yaml", "--no-report"}).status, 1);
  EXPECT_FALSE(exists("rehearse-pending/Box.Falls.html"));
  done({"golden", "accept", "Box.Falls"});
  const Outcome same = with_page({"check", "falls.yaml", "--json"});
  EXPECT_EQ(same.status, 0);
  EXPECT_TRUE(same.json()["report"].is_null());
  EXPECT_FALSE(exists("rehearse-pending/Box.Falls.html"));
}

TEST_F(CheckReportPage, ThatCanNotBeWrittenIsAWarningAndChangesNoStatus) {
  make_repository();
  fs::create_directories(folder() / "rehearse-pending");
  write("rehearse-pending/Box.Falls.html", "somebody's notes");
  const Outcome outcome = with_page({"check", "falls.yaml"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("warning: won't replace"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("in a browser")));
}

}  // namespace
}  // namespace rehearse::test
