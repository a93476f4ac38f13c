// A page gets the whole state as one text by WebSocket, at first and whenever it changes: {scenarios, build, waiting}.
// It asks by POST, with a JSON object: /allow, /check, /look, /accept, /reject, /open, /report. An answer is {} or
// {error}, that of /report the report.
#include "project_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "viewing/live/web_server.h"
#include "viewing/report/small_page.h"

namespace rehearse {

/// The content and the script of the page (project_page_parts.cpp.in).
std::string_view project_page_content();
std::string_view project_page_script();

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::chrono::milliseconds step_time{15};
constexpr std::string_view magic = "<!doctype html><!-- the page of a project of Rehearse -->";

/// Anyone on this machine may get it, so it doesn't name the project.
std::string page_without_content() {
  return small_page({.magic = magic,
                     .kind = "Rehearse",
                     .title = "The page of a project",
                     .content = std::string(project_page_content()) + "<script>\n" +
                                std::string(project_page_script()) + "</script>\n"});
}

WebServer::Answer answer_of(const Result<void>& done) {
  if (done) return {};
  return {409, "application/json", Json{{"error", to_string(done.errors()[0])}}.dump()};
}

std::string text_in(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace

struct ProjectPage::Impl : WebServer::Handler {
  Impl(ProjectPageOptions all_options, ProjectChecks all_checks)
      : options(std::move(all_options)), checks(std::move(all_checks)) {}

  void opened(WebServer::Client client, std::string_view /*protocol*/) override {
    clients.insert(client);
    server->send_text(client, sent);
  }
  void took_text(WebServer::Client /*client*/, std::string_view /*text*/) override {}
  void took_bytes(WebServer::Client /*client*/, std::span<const std::byte> /*bytes*/) override {}
  void closed(WebServer::Client client) override { clients.erase(client); }
  void refused(const std::string& /*reason*/) override {}
  std::optional<WebServer::Answer> asked(const WebServer::Request& request) override;

  WebServer::Answer report(const std::string& file) const;
  Result<void> open_in_editor(const std::string& file, std::int64_t line);
  void send_state();

  ProjectPageOptions options;
  ProjectChecks checks;
  std::string token;
  std::unique_ptr<WebServer> server;
  std::set<WebServer::Client> clients;
  std::vector<RunningProgram> editors;
  std::string sent;  // the state that all pages have
};

std::optional<WebServer::Answer> ProjectPage::Impl::asked(const WebServer::Request& request) {
  if (!request.is_post) return std::nullopt;
  const Json asked = Json::parse(request.body, nullptr, false);
  if (!asked.is_object()) return answer_of(error("the content is no JSON object"));
  const std::string file = text_in(asked, "file"), golden = text_in(asked, "golden");
  const auto stated = asked.find("line");
  const std::int64_t line = stated != asked.end() && stated->is_number_integer() ? stated->get<std::int64_t>() : 1;
  const std::map<std::string_view, std::function<WebServer::Answer()>> answers{
      {"/allow", [&] { return answer_of(checks.allow()); }},
      {"/check", [&] { return checks.check_all(), WebServer::Answer{}; }},
      {"/look", [&] { return answer_of(checks.look_at(file)); }},
      {"/accept", [&] { return answer_of(checks.decide(golden, true)); }},
      {"/reject", [&] { return answer_of(checks.decide(golden, false)); }},
      {"/open", [&] { return answer_of(open_in_editor(file, line)); }},
      {"/report", [&] { return report(file); }}};
  const auto found = answers.find(request.path);
  if (found == answers.end()) return std::nullopt;
  WebServer::Answer answer = found->second();
  send_state();
  return answer;
}

WebServer::Answer ProjectPage::Impl::report(const std::string& file) const {
  const auto place = checks.report_of(file);
  if (!place) return answer_of(place.errors());
  std::ifstream stream(*place, std::ios::binary);
  if (!stream) return answer_of(error_in(place->string(), "it can't be read"));
  return {200, "text/html; charset=utf-8", std::string(std::istreambuf_iterator<char>(stream), {})};
}

Result<void> ProjectPage::Impl::open_in_editor(const std::string& file, std::int64_t line) {
  if (options.editor.empty()) return error("no editor is named", "start it with --editor 'code -g {file}:{line}'");
  std::error_code failed;
  const fs::path project = fs::canonical(options.checks.project, failed);
  const fs::path place = fs::canonical(project / file, failed);
  const auto [end, ignored] = std::ranges::mismatch(project, place);
  if (failed || end != project.end() || !fs::is_regular_file(place, failed))
    return error(fmt::format("the project has no file '{}'", file));
  ChildProcess process;
  for (const std::string& word : options.editor) {
    std::string given;
    for (std::size_t at = 0; at < word.size();) {
      const std::string_view rest = std::string_view(word).substr(at);
      if (rest.starts_with("{file}")) {
        given += place.string();
        at += 6;
      } else if (rest.starts_with("{line}")) {
        given += std::to_string(line);
        at += 6;
      } else {
        given += word[at++];
      }
    }
    process.words.push_back(std::move(given));
  }
  process.environment = environment_with({});
  process.folder = project;
  editors.push_back(REHEARSE_TRY(RunningProgram::start(std::move(process))));
  return {};
}

void ProjectPage::Impl::send_state() {
  Json state = checks.state();
  state["has_editor"] = !options.editor.empty();
  std::string text = state.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (text == sent) return;
  sent = std::move(text);
  for (const WebServer::Client client : std::set(clients)) server->send_text(client, sent);
}

ProjectPage::ProjectPage(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ProjectPage::~ProjectPage() = default;

Result<std::unique_ptr<ProjectPage>> ProjectPage::open(ProjectPageOptions options) {
  auto checks = REHEARSE_TRY(ProjectChecks::open(options.checks));
  auto impl = std::make_unique<Impl>(std::move(options), std::move(checks));
  impl->token = REHEARSE_TRY(new_token());
  impl->send_state();
  WebServer::Options web;
  web.port = impl->options.port;
  web.token = impl->token;
  web.page = page_without_content();
  impl->server = REHEARSE_TRY(WebServer::listen(std::move(web), *impl));
  return std::unique_ptr<ProjectPage>(new ProjectPage(std::move(impl)));
}

std::string ProjectPage::address() const {
  return fmt::format("http://127.0.0.1:{}/#token={}", impl_->server->port(), impl_->token);
}

void ProjectPage::step() {
  impl_->server->run_for(step_time);
  const bool has_changed = impl_->checks.step();
  std::erase_if(impl_->editors, [](RunningProgram& editor) {
    const auto status = editor.ended();
    return !status || status->has_value();
  });
  if (has_changed) impl_->send_state();
}

void ProjectPage::stop() {
  impl_->checks.stop();
  impl_->server->stop();
}

}  // namespace rehearse
