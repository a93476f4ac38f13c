#include "unread_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <tuple>

#include "base/names.h"
#include "controller_host.h"

namespace cnoid {

/// The states of a link whose functions were called.
struct AccessedStates {
  static short of(const Link& link) { return link.accessedStates_; }
  static void reset(Link& link) { link.accessedStates_ = Link::StateNone; }
};

}  // namespace cnoid

namespace rehearse {
namespace {

using CnoidLink = cnoid::Link;
using cnoid::AccessedStates;

/// True if a controller of that body has enabled the quantity.
bool is_input(const std::vector<HostedController>& controllers, const IoBody& body, int link, Quantity quantity) {
  return std::ranges::any_of(controllers, [&](const HostedController& hosted) {
    return hosted.io_body.get() == &body && std::ranges::any_of(hosted.io->inputs().fields, [&](const IoField& field) {
             return field.link == link && field.quantity == quantity;
           });
  });
}

bool is_same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

}  // namespace

void UnreadInputs::begin(const std::vector<HostedController>& controllers) {
  for (const HostedController& hosted : controllers) {
    const auto has_it = [&](const Watched& known) { return known.body == hosted.io_body; };
    if (!hosted.running || !hosted.io_body || std::ranges::any_of(watched_, has_it)) continue;
    Watched& watched = watched_.emplace_back();
    watched.body = hosted.io_body;
    for (int i = 0; i < watched.body->body().numLinks(); ++i) {
      CnoidLink& link = *watched.body->body().link(i);
      watched.q.push_back(link.q());
      watched.dq.push_back(link.dq());
      AccessedStates::reset(link);
    }
  }
}

std::vector<std::string> UnreadInputs::found(const std::vector<HostedController>& controllers) const {
  std::vector<std::string> sentences;
  for (const Watched& watched : watched_) {
    const auto leader = std::ranges::find(controllers, watched.body, &HostedController::io_body);
    for (const auto& [flag, quantity, name] : {std::tuple(CnoidLink::JointDisplacement, Quantity::q, "Displacement"),
                                               std::tuple(CnoidLink::JointVelocity, Quantity::dq, "Velocity")}) {
      std::vector<std::string> joints;
      double first = 0.0;
      for (int i = 0; i < watched.body->body().numLinks(); ++i) {
        CnoidLink& link = *watched.body->body().link(i);
        const auto place = static_cast<std::size_t>(i);
        const bool is_called = AccessedStates::of(link) & flag;
        if (!is_called || link.jointId() < 0 || is_input(controllers, *watched.body, i, quantity)) continue;
        const double before = quantity == Quantity::q ? watched.q[place] : watched.dq[place];
        if (!is_same(quantity == Quantity::q ? link.q() : link.dq(), before)) continue;
        if (joints.empty()) first = before;
        joints.push_back(fmt::format("'{}'", watched.body->model().links[place].joint.name));
      }
      if (joints.empty()) continue;
      sentences.push_back(
          fmt::format("{} calls {}() of joint{} {} and never enabled that input: the value stays {:g} in all ticks "
                      "(io->enableInput(joint, cnoid::Link::Joint{}) in initialize())",
                      leader->label, name_of(quantity), joints.size() > 1 ? "s" : "", listed(joints, 4), first, name));
    }
  }
  return sentences;
}

}  // namespace rehearse
