#include "urdf_draft.h"

#include <fmt/format.h>

#include <map>
#include <string_view>

namespace rehearse::urdf {
namespace {

/// The joints of a draft and their leaders.
class Followers {
 public:
  explicit Followers(const Draft& draft) {
    for (const JointDraft& joint : draft.joints) joints_.emplace(joint.joint.name, &joint);
  }

  /// The mimic of `joint`, resolved along the chain to a joint that follows no other. Returns nullopt if the chain has
  /// no such end. The error is reported for the joint that names the missing leader, and for each joint in a circle.
  std::optional<MimicDraft> resolve(const JointDraft& joint, Findings& findings) const {
    MimicDraft whole = *joint.mimic;
    for (std::size_t steps = 0;; ++steps) {
      const auto leader = joints_.find(whole.leader);
      if (leader == joints_.end() || !is_movable(leader->second->joint.type)) {
        if (steps == 0)
          findings.error(whole.line, fmt::format("joint {} mimics {}, which {}", in_quotes(joint.joint.name),
                                                 in_quotes(whole.leader),
                                                 leader == joints_.end() ? "is not a joint" : "doesn't move"));
        return std::nullopt;
      }
      const JointDraft& above = *leader->second;
      if (!above.mimic) return whole;
      if (&above == &joint) {
        findings.error(joint.mimic->line,
                       fmt::format("joint {} mimics itself{}", in_quotes(joint.joint.name),
                                   steps == 0 ? "" : ", by way of " + in_quotes(joint.mimic->leader)),
                       "one joint of the circle has to move by itself");
        return std::nullopt;
      }
      if (steps > joints_.size()) return std::nullopt;  // the chain leads into a circle
      whole.offset += whole.multiplier * above.mimic->offset;
      whole.multiplier *= above.mimic->multiplier;
      whole.leader = above.mimic->leader;
    }
  }

 private:
  std::map<std::string_view, const JointDraft*> joints_;
};

}  // namespace

void resolve_mimics(const Draft& draft, Model& model, Findings& findings) {
  const Followers followers(draft);
  for (const JointDraft& joint : draft.joints) {
    if (!joint.mimic) continue;
    const auto whole = followers.resolve(joint, findings);
    if (!whole) continue;
    Joint& follower = model.links[static_cast<std::size_t>(model.find_joint(joint.joint.name))].joint;
    const Joint& leader = model.links[static_cast<std::size_t>(model.find_joint(whole->leader))].joint;
    for (const Joint* part : {static_cast<const Joint*>(&follower), &leader}) {
      if (part->type == JointType::track)
        findings.error(joint.mimic->line, fmt::format("joint {} mimics {}, but {} is a track", in_quotes(follower.name),
                                                      in_quotes(leader.name), in_quotes(part->name)));
    }
    follower.mimic = Mimic{leader.id, whole->multiplier, whole->offset};
  }
}

}  // namespace rehearse::urdf
