#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cnoid/Signal>

#include <stdexcept>

namespace {

using cnoid::Connection;
using cnoid::ScopedConnection;
using cnoid::Signal;
using cnoid::SignalProxy;
using testing::ElementsAre;
using testing::IsEmpty;

TEST(Signal, CallsItsSlotsInTheOrderOfConnection) {
  Signal<void(int)> signal;
  std::vector<int> calls;
  signal.connect([&](int value) { calls.push_back(10 + value); });
  signal.connect([&](int value) { calls.push_back(20 + value); });
  signal(3);
  EXPECT_THAT(calls, ElementsAre(13, 23));
}

TEST(Signal, CallsADisconnectedSlotNoMore) {
  Signal<void()> signal;
  int calls = 0;
  Connection connection = signal.connect([&] { ++calls; });
  signal();
  connection.disconnect();
  signal();
  EXPECT_EQ(calls, 1);
  EXPECT_FALSE(connection.connected());
  EXPECT_FALSE(signal.hasConnections());
}

TEST(Signal, PassesOverABlockedSlotUntilItIsUnblockedAsOften) {
  Signal<void()> signal;
  int calls = 0;
  Connection connection = signal.connect([&] { ++calls; });
  connection.block();
  {
    const Connection::ScopedBlock again = connection.scopedBlock();
    signal();
  }
  signal();
  EXPECT_EQ(calls, 0);
  EXPECT_TRUE(connection.isBlocked());
  connection.unblock();
  signal();
  EXPECT_EQ(calls, 1);
}

TEST(Signal, CallsASlotConnectedDuringAnEmissionFromTheNextOn) {
  Signal<void()> signal;
  int late = 0;
  bool connected = false;
  signal.connect([&] {
    if (!connected) signal.connect([&] { ++late; });
    connected = true;
  });
  signal();
  EXPECT_EQ(late, 0);
  signal();
  EXPECT_EQ(late, 1);
}

TEST(Signal, LeavesOutASlotDisconnectedDuringTheEmission) {
  Signal<void()> signal;
  int calls = 0;
  Connection second;
  signal.connect([&] { second.disconnect(); });
  second = signal.connect([&] { ++calls; });
  signal();
  EXPECT_EQ(calls, 0);
}

TEST(Signal, FinishesAnEmissionBeforeOneFromWithinIt) {
  Signal<void(int)> signal;
  std::vector<int> calls;
  signal.connect([&](int value) {
    if (value == 1) signal(2);
  });
  signal.connect([&](int value) { calls.push_back(value); });
  signal(1);
  EXPECT_THAT(calls, ElementsAre(1, 2));
}

TEST(Signal, WorksAgainAfterASlotThrew) {
  Signal<void(bool)> signal;
  int calls = 0;
  signal.connect([&](bool fail) {
    ++calls;
    if (fail) throw std::runtime_error("slot");
  });
  EXPECT_THROW(signal(true), std::runtime_error);
  signal(false);
  EXPECT_EQ(calls, 2);
}

TEST(Signal, EndsItsConnectionsWithItself) {
  Connection connection;
  {
    Signal<void()> signal;
    connection = signal.connect([] {});
    EXPECT_TRUE(connection.connected());
  }
  EXPECT_FALSE(connection.connected());
}

TEST(ScopedConnection, DisconnectsAtTheEndOfItsScope) {
  Signal<void()> signal;
  int calls = 0;
  {
    const ScopedConnection connection = signal.connect([&] { ++calls; });
    signal();
  }
  signal();
  EXPECT_EQ(calls, 1);
}

TEST(ScopedConnectionSet, DisconnectsAllOfThem) {
  Signal<void()> signal;
  cnoid::ScopedConnectionSet connections;
  connections.add(signal.connect([] {}));
  connections.add(signal.connect([] {}));
  EXPECT_TRUE(signal.hasConnections());
  connections.disconnect();
  EXPECT_FALSE(signal.hasConnections());
}

TEST(SignalProxy, ConnectsToTheSignalBehindIt) {
  Signal<void()> signal;
  int calls = 0;
  SignalProxy<void()>(signal).connect([&] { ++calls; });
  signal();
  EXPECT_EQ(calls, 1);
}

TEST(SignalProxy, OfNothingAcceptsSlotsAndNeverCallsThem) {
  SignalProxy<void()> proxy;
  EXPECT_FALSE(proxy.connect([] {}).connected());
  EXPECT_FALSE(proxy.hasConnections());
}

}  // namespace
