// ProjectPage: one page for a project, which a browser on this machine shows: its scenarios with their verdicts, kept
// true while its files change, the report of what failed, and the runs that wait for a decision. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "project_checks.h"

namespace rehearse {

struct ProjectPageOptions {
  ProjectChecksOptions checks;
  std::uint16_t port = 0;  // 0: any free port
  /// The program that opens a file, and its arguments, with {file} and {line} in them; empty: none.
  std::vector<std::string> editor = {};
};

class ProjectPage {
 public:
  /// Fails if the port is in use, or if the project's files can't be watched.
  static Result<std::unique_ptr<ProjectPage>> open(ProjectPageOptions options);
  ~ProjectPage();

  /// Its address, with the token behind the #: a browser doesn't send that part.
  std::string address() const;
  /// Serves the page, and looks after the project, for a few milliseconds.
  void step();
  /// Ends all that runs, and all connections.
  void stop();

 private:
  struct Impl;
  explicit ProjectPage(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rehearse
