#include "urdf_draft.h"
#include "urdf_suggestions.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>

namespace rehearse::urdf {
namespace {

/// The graph of links and joints, by index into the draft.
struct Graph {
  std::map<std::string_view, int> link_by_name;
  std::map<std::string_view, int> joint_by_name;
  std::vector<int> parent_joint;           // by link; -1 without
  std::vector<int> parent_link;            // by link; -1 without
  std::vector<std::vector<int>> children;  // by link: the joints below it, in document order
};

std::size_t index(int i) { return static_cast<std::size_t>(i); }

void name_parts(const Draft& draft, Graph& graph, Findings& findings) {
  const auto add = [&](auto& names, const auto& part, int i, const char* kind, const auto& line_of) {
    const auto [found, is_new] = names.emplace(part.name, i);
    if (is_new) return;
    findings.error(part.line, fmt::format("a second {} with the name {}, after the one in line {}", kind,
                                          in_quotes(part.name), line_of(found->second)));
  };
  for (std::size_t i = 0; i < draft.links.size(); ++i) {
    add(graph.link_by_name, draft.links[i].link, static_cast<int>(i), "link",
        [&](int first) { return draft.links[index(first)].link.line; });
  }
  for (std::size_t i = 0; i < draft.joints.size(); ++i) {
    add(graph.joint_by_name, draft.joints[i].joint, static_cast<int>(i), "joint",
        [&](int first) { return draft.joints[index(first)].joint.line; });
  }
}

/// Index of the link that a joint names, or -1 with an error.
int end_of(const JointDraft& joint, const char* end, const std::string& name, const Graph& graph, Suggestions& links,
           Findings& findings) {
  const auto found = graph.link_by_name.find(name);
  if (found != graph.link_by_name.end()) return found->second;
  findings.error(
      joint.joint.line,
      fmt::format("joint {} has the {} {}, which is not a link", in_quotes(joint.joint.name), end, in_quotes(name)),
      links.of(name));
  return -1;
}

void connect(const Draft& draft, Graph& graph, Findings& findings) {
  graph.parent_joint.assign(draft.links.size(), -1);
  graph.parent_link.assign(draft.links.size(), -1);
  graph.children.resize(draft.links.size());
  Suggestions links("links");
  for (const LinkDraft& link : draft.links) links.add(link.link.name);
  for (std::size_t i = 0; i < draft.joints.size(); ++i) {
    const JointDraft& joint = draft.joints[i];
    const int parent = end_of(joint, "parent", joint.parent, graph, links, findings);
    const int child = end_of(joint, "child", joint.child, graph, links, findings);
    if (parent < 0 || child < 0) continue;
    if (const int other = graph.parent_joint[index(child)]; other >= 0) {
      findings.error(joint.joint.line,
                     fmt::format("link {} has two parents: joint {} in line {} and joint {}", in_quotes(joint.child),
                                 in_quotes(draft.joints[index(other)].joint.name),
                                 draft.joints[index(other)].joint.line, in_quotes(joint.joint.name)));
      continue;
    }
    graph.parent_joint[index(child)] = static_cast<int>(i);
    graph.parent_link[index(child)] = parent;
    graph.children[index(parent)].push_back(static_cast<int>(i));
  }
}

/// Reports each loop once. A link from which the way up never reaches a root is in a loop or below one.
void find_loops(const Draft& draft, const Graph& graph, Findings& findings) {
  std::vector<int> seen_from(draft.links.size(), -1);
  for (std::size_t start = 0; start < draft.links.size(); ++start) {
    int at = static_cast<int>(start);
    while (at >= 0 && seen_from[index(at)] < 0) {
      seen_from[index(at)] = static_cast<int>(start);
      at = graph.parent_link[index(at)];
    }
    if (at < 0 || seen_from[index(at)] != static_cast<int>(start)) continue;
    const Joint& joint = draft.joints[index(graph.parent_joint[index(at)])].joint;
    findings.error(joint.line,
                   fmt::format("a loop: joint {} makes link {} its own ancestor", in_quotes(joint.name),
                               in_quotes(draft.links[index(at)].link.name)),
                   "links and joints form a tree");
  }
}

/// The one link without a parent, or -1 with an error.
int find_root(const Draft& draft, const Graph& graph, Findings& findings) {
  std::vector<int> roots;
  for (std::size_t i = 0; i < draft.links.size(); ++i) {
    if (graph.parent_joint[i] < 0) roots.push_back(static_cast<int>(i));
  }
  if (roots.size() == 1) return roots.front();
  if (roots.empty()) return -1;  // a loop, already reported
  std::string names;
  constexpr std::size_t most_names = 20;
  for (std::size_t i = 0; i < std::min(roots.size(), most_names); ++i) {
    names += (i == 0 ? "" : ", ") + in_quotes(draft.links[index(roots[i])].link.name);
  }
  if (roots.size() > most_names) names += ", ...";
  findings.error(draft.links[index(roots[1])].link.line, fmt::format("{} root links: {}", roots.size(), names),
                 "a robot has one link that is no joint's child");
  return -1;
}

/// True if the link is only a name for the world.
bool is_bare_world(const Draft& draft, const Graph& graph, int root) {
  const LinkDraft& link = draft.links[index(root)];
  return link.link.name == "world" && !link.has_inertial && link.link.visuals.empty() && link.link.collisions.empty() &&
         graph.children[index(root)].size() == 1;
}

/// The root of the model: the child of a floating joint that is the only joint below a bare 'world', else the file's
/// root. The child of any other floating joint is a free body that begins at the joint.
int skip_bare_world(const Draft& draft, const Graph& graph, int root, Findings& findings) {
  int base = root;
  const bool is_bare = is_bare_world(draft, graph, root);
  for (const JointDraft& draft_joint : draft.joints) {
    const Joint& joint = draft_joint.joint;
    if (joint.type != JointType::free) continue;
    if (is_bare && draft_joint.parent == "world") {
      base = graph.link_by_name.at(draft_joint.child);
      findings.note(joint.line, fmt::format("floating joint {} below 'world': link {} is the free root",
                                            in_quotes(joint.name), in_quotes(draft_joint.child)));
    } else {
      findings.note(joint.line, fmt::format("floating joint {}: link {} is a free body, which begins at the joint",
                                            in_quotes(joint.name), in_quotes(draft_joint.child)));
    }
  }
  return base;
}

/// By joint of the draft: its id, -1 for joints without an id.
std::vector<int> number_joints(const Draft& draft) {
  std::vector<int> ids;
  int next = 0;
  for (const JointDraft& joint : draft.joints) ids.push_back(has_id(joint.joint.type) ? next++ : -1);
  return ids;
}

/// Depth-first without recursion: a chain may be as long as a file allows.
void add_links(const Draft& draft, const Graph& graph, int root, Model& model) {
  const std::vector<int> ids = number_joints(draft);
  model.joints.assign(static_cast<std::size_t>(std::ranges::count_if(ids, [](int id) { return id >= 0; })), -1);

  struct Place {
    int link;    // in the draft
    int parent;  // in the model
  };
  std::vector<Place> open = {{root, -1}};
  while (!open.empty()) {
    const Place place = open.back();
    open.pop_back();
    const int here = static_cast<int>(model.links.size());
    Link& link = model.links.emplace_back(draft.links[index(place.link)].link);
    link.parent = place.parent;
    if (place.parent < 0) {
      link.joint.type = link.name == "world" || draft.is_static ? JointType::fixed : JointType::free;
    } else {
      const int joint = graph.parent_joint[index(place.link)];
      link.joint = draft.joints[index(joint)].joint;
      link.joint.id = ids[index(joint)];
      if (link.joint.id >= 0) model.joints[index(link.joint.id)] = here;
    }
    const std::vector<int>& below = graph.children[index(place.link)];
    for (auto joint = below.rbegin(); joint != below.rend(); ++joint) {
      open.push_back({graph.link_by_name.at(draft.joints[index(*joint)].child), here});
    }
  }
}

void set_tracks(const Draft& draft, Model& model, Findings& findings) {
  for (const TrackDraft& track : draft.tracks) {
    const int link = model.find_joint(track.reference);
    if (link < 1) {
      findings.error(track.line, fmt::format("a track on {}, which is neither a joint nor a link below one",
                                             in_quotes(track.reference)));
      continue;
    }
    Joint& joint = model.links[index(link)].joint;
    if (joint.type != JointType::continuous) {
      findings.error(track.line,
                     fmt::format("joint {} can't be a track: it is {}", in_quotes(joint.name), type_name(joint.type)),
                     "a continuous joint, whose axis is that of the track's wheels");
      continue;
    }
    joint.type = JointType::track;
  }
}

}  // namespace

std::optional<Model> join(const Draft& draft, Findings& findings) {
  if (draft.links.empty()) {
    if (draft.is_complete) findings.error(0, "the robot has no links");
    return std::nullopt;
  }
  const int errors_before = findings.error_count();
  Graph graph;
  name_parts(draft, graph, findings);
  connect(draft, graph, findings);
  find_loops(draft, graph, findings);
  // With a missing or doubtful part, other links would wrongly appear as roots.
  if (!draft.is_complete || findings.error_count() > errors_before) return std::nullopt;
  const int root = find_root(draft, graph, findings);
  if (root < 0) return std::nullopt;

  Model model;
  model.name = draft.name;
  add_links(draft, graph, skip_bare_world(draft, graph, root, findings), model);
  if (draft.is_static && !model.joints.empty())
    findings.warning(draft.static_line, "<static> fixes the root link to the world; the joints move nevertheless");
  apply_surfaces(draft, model, findings);
  place_devices(draft, model, findings);
  apply_joint_parts(draft, model, findings);
  set_tracks(draft, model, findings);
  resolve_mimics(draft, model, findings);
  return model;
}

}  // namespace rehearse::urdf
