// Orders of threads: eight controllers that depend on theirs, which an audit finds, reduces and repeats, and twelve
// that don't. The table is printed after all tests.
#include "audited.h"
#include "support/printed_by_name.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cstdlib>

namespace rehearse::test {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::StartsWith;

struct Guest {
  const char* name;     // the option of controllers/orders.cpp
  const char* verdict;  // a part of it; null: the commands are the same in all orders
};

const Guest guests[] = {
    {"stale_plan", "hinge/u of"},
    {"lost_update", "hinge/u of"},
    {"missed_wake_up", "hinge/u of"},
    {"publish_before_write", "hinge/u of"},
    {"lock_order", "never goes on, because its threads wait for each other"},
    {"use_after_stop", "segmentation fault"},
    {"torn_pair", "hinge/u of"},
    {"first_come", "hinge/u of"},
    {"last_plan", nullptr},
    {"awaited_plan", nullptr},
    {"kept_update", nullptr},
    {"one_lock_order", nullptr},
    {"whole_pair", nullptr},
    {"own_places", nullptr},
    {"sum", nullptr},
    {"futures", nullptr},
    {"ping_pong", nullptr},
    {"once", nullptr},
    {"log", nullptr},
    {"readers", nullptr},
};

std::vector<std::string>& order_rows() {
  static std::vector<std::string> rows;
  return rows;
}

class OrdersTable : public ::testing::Environment {
  void TearDown() override {
    if (order_rows().empty()) return;
    fmt::print("controller            found in order  exchanges\n");
    for (const std::string& row : order_rows()) fmt::print("{}\n", row);
  }
};
const auto* const orders_table = ::testing::AddGlobalTestEnvironment(new OrdersTable);

class OrderedGuest : public Audited, public ::testing::WithParamInterface<Guest> {};

TEST_P(OrderedGuest, IsJudgedByItsOrders) {
  const Guest& guest = GetParam();
  done({"record", scenario("orders", guest.name).string(), "-o", "run.mcap"});
  // more orders of those that don't depend on theirs: REHEARSE_ORDERS=500
  const char* const more = std::getenv("REHEARSE_ORDERS");
  const std::string orders = guest.verdict ? "500" : more ? more : "20";
  const Outcome outcome = rehearse({"audit", "run.mcap", "--orders", orders, "--json", "-o", "found.json"});
  const nlohmann::json report = outcome.json();
  const nlohmann::json& tried = report["orders"];
  if (!guest.verdict) {
    EXPECT_EQ(outcome.status, 0) << report["verdict"];
    EXPECT_THAT(report["verdict"], StartsWith("Pendulum/Zoo gave the same 200 commands, bit for bit, in " + orders));
    EXPECT_EQ(tried["tried"], std::stoi(orders));
    EXPECT_GT(tried["places"], 0);
    EXPECT_FALSE(fs::exists(folder() / "found.json"));
    order_rows().push_back(fmt::format("{:<22}in none of {}", guest.name, orders));
    return;
  }
  EXPECT_EQ(outcome.status, 1) << report["verdict"];
  EXPECT_THAT(report["verdict"], StartsWith("Pendulum/Zoo depends on the order of threads: "));
  EXPECT_THAT(report["verdict"], HasSubstr(guest.verdict));
  EXPECT_THAT(report["verdict"], HasSubstr(" runs before "));
  ASSERT_GE(tried["exchanges"].size(), 1u) << report["verdict"];
  EXPECT_LE(tried["exchanges"].size(), 3u) << report["verdict"];
  for (const nlohmann::json& exchange : tried["exchanges"])
    for (const char* thread : {"runs", "before"})
      EXPECT_THAT(std::string(exchange[thread]),
                  MatchesRegex("(the call itself|'worker'|thread [12])( .orders.cpp:[0-9]+.)?"));
  const std::vector<std::string> replay = {"replay", "run.mcap", "--order", "found.json", "--json"};
  const Outcome repeated = rehearse(replay);
  EXPECT_NE(repeated.status, 0);
  EXPECT_EQ(repeated.json()["first"], rehearse(replay).json()["first"]);
  EXPECT_EQ(rehearse({"replay", "run.mcap"}).status, 0) << "without the order";
  order_rows().push_back(
      fmt::format("{:<22}{:<16}{}", guest.name, tried["tried"].get<int>(), tried["exchanges"].size()));
}

INSTANTIATE_TEST_SUITE_P(Of, OrderedGuest, ::testing::ValuesIn(guests), by_name);

TEST_F(Audited, SaysThatAControllerWithoutThreadsHasOneOrder) {
  const Outcome outcome = done({"audit", scenario("good_own_generator").string(), "--orders", "5"});
  EXPECT_EQ(outcome.out,
            "there is no other order to try: at no place are several threads of Pendulum/Zoo ready that take turns\n");
}

/// Nothing is said of an order if the commands differ without one.
TEST_F(Audited, BlamesNoOrderForAnotherCause) {
  done({"record", scenario("rand").string(), "-o", "run.mcap"});
  const Outcome outcome =
      rehearse({"audit", "run.mcap", "--controller", "Zoo=" ZOO "/zoo_random_device.so", "--orders", "5"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, StartsWith("unknown: in one order of threads hinge/u of /Pendulum/Zoo/output/joints differs "
                                      "at tick 0 from replay to replay"));
}

TEST_F(Audited, RefusesAFileThatIsNoOrder) {
  done({"record", scenario("orders", "sum").string(), "-o", "run.mcap"});
  write("wrong.json", "{\"exchanges\": []}");
  const Outcome outcome = rehearse({"replay", "run.mcap", "--order", "wrong.json"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("wrong.json isn't the file of an order of threads"));
  const Outcome audit = rehearse({"audit", "run.mcap", "--orders", "5", "-o", "wrong.json"});
  EXPECT_EQ(audit.status, 2) << "it is left alone";
  const Outcome beside = rehearse({"replay", "run.mcap", "--order", "wrong.json", "--coverage"});
  EXPECT_EQ(beside.status, 2);
  EXPECT_THAT(beside.err, HasSubstr("these replay in the usual order"));
}

}  // namespace
}  // namespace rehearse::test
