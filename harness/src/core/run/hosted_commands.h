// HostedCommands: the commands of a run come from its controllers.
#pragma once

#include "core/host/controller_host.h"
#include "run.h"

namespace rehearse {

class HostedCommands final : public Commander {
 public:
  /// When the commands are written into the run's command. Numbers that aren't finite are reported at that time.
  enum class Written {
    in_time,  // the commands of each controller before or after the step: a world moves, or has moved
    at_once,  // all commands before the step, which moves nothing: the robot of a log
    never,    // the controllers' outputs are read from the host instead
  };

  /// The host must outlive this.
  HostedCommands(ControllerHost& host, Written written) : host_(host), written_(written) {}

  bool failed() const override { return host_.failure().has_value(); }
  void prepare(TickData& now) override {
    now.host = &host_;
    now.alive = host_.input(now.tick, *now.read);
  }
  void act(TickData& now) override {
    now.alive = now.alive && host_.control();
    if (written_ != Written::never) host_.output(Timing::same_step, now.command);
    if (written_ == Written::at_once) host_.output(Timing::next_step, now.command);
  }
  void act_late(TickData& now) override {
    if (written_ == Written::in_time) host_.output(Timing::next_step, now.command);
  }

 private:
  ControllerHost& host_;
  const Written written_;
};

}  // namespace rehearse
