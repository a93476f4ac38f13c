// The robots of a report: the bodies of the scenario, the tree of their links, and the series that move them. Internal.
#pragma once

#include <rehearse/model.h>
#include <rehearse/scenario.h>

#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "report_blobs.h"
#include "report_run.h"

namespace rehearse {

class RobotWriter {
 public:
  /// `scenario_file`: meshes are searched beside it; empty: beside the recording and in the folders above it. Parts
  /// that can't be drawn are reported in `omitted`.
  RobotWriter(BlobWriter& blobs, const ReportedRun& run, std::filesystem::path scenario_file,
              std::vector<std::string>& omitted)
      : blobs_(blobs), run_(run), scenario_file_(std::move(scenario_file)), omitted_(omitted) {}

  void write(const Scenario& scenario);
  /// True if a robot moves by series of that topic.
  bool uses(std::string_view topic) const { return topics_.find(topic) != topics_.end(); }

  ReportJson take_robots() { return std::move(robots_); }
  ReportJson take_meshes() { return std::move(meshes_); }

 private:
  void write_body(const ScenarioBody& body);
  ReportJson link_json(const ScenarioBody& body, const Link& link, const Link& drawn, int index);
  ReportJson joint_json(const ScenarioBody& body, const Link& link);
  ReportJson pose_series(const ScenarioBody& body, const Link& link);
  ReportJson shapes_json(const ScenarioBody& body, const Link& link);
  void add_shape(ReportJson& shapes, const Shape& shape);
  int mesh_of(const MeshData& mesh, const Shape& shape);
  std::shared_ptr<const Model> with_meshes(const ScenarioBody& body);
  bool is_as_recorded(const ScenarioBody& body, const Mesh& mesh) const;

  BlobWriter& blobs_;
  const ReportedRun& run_;
  std::filesystem::path scenario_file_;
  std::vector<std::string>& omitted_;
  std::set<std::string, std::less<>> topics_;
  std::map<std::tuple<std::string, std::vector<float>, std::vector<double>>, int> known_meshes_;
  std::set<std::string> missing_, changed_;  // meshes of the present body
  ReportJson robots_ = ReportJson::array(), meshes_ = ReportJson::array();
};

}  // namespace rehearse
