#include "hosted_commands.h"

namespace rehearse {

void HostedCommands::act(Moment& now) {
  now.host = &host_;
  now.alive = host_.control(now.tick, *now.read);
  if (written_ != Written::never) host_.output(Timing::same_step, now.command);
  if (written_ == Written::at_once) host_.output(Timing::next_step, now.command);
}

void HostedCommands::act_late(Moment& now) {
  if (written_ == Written::in_time) host_.output(Timing::next_step, now.command);
}

}  // namespace rehearse
