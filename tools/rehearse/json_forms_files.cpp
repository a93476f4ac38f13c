// The objects of verbs on files: info, report, export, doctor, recover, filter, merge, inspect and import.
#include <string>
#include <utility>
#include <vector>

#include "json_forms.h"

namespace rehearse::tool {
namespace {

ValueType strings() { return types::array(types::string()); }
ValueType maybe_string() { return types::nullable(types::string()); }

const Form& schema_of_channel_form() {
  static const Form form{"message_schema",
                         "a schema of messages",
                         {member("id", types::count()), member("name", types::string()),
                          member("encoding", types::string()), member("data", types::string())}};
  return form;
}

const Form& channel_of_file_form() {
  static const Form form{
      "channel",
      "a channel",
      {member("id", types::count()), member("topic", types::string()), member("type", types::string()),
       member("schema_id", types::count()), member("message_encoding", types::string()),
       member("metadata", types::map(types::string())), member("messages", types::count()),
       member("rate", types::real()), member("bytes", types::nullable(types::count()))}};
  return form;
}

const Form& statistics_form() {
  static const Form form = [] {
    Form statistics{"statistics", "the statistics record", {}};
    for (const std::string_view name : {"message_count", "schema_count", "channel_count", "attachment_count",
                                        "metadata_count", "chunk_count", "message_start_time", "message_end_time"})
      statistics.keys.push_back(member(name, types::count()));
    statistics.keys.push_back(member("channel_message_counts", types::map(types::count())));
    return statistics;
  }();
  return form;
}

const Form& compression_form() {
  static const Form form{
      "compression",
      "a compression",
      {member("compression", types::string()), member("chunks", types::count()), member("stored_bytes", types::count()),
       member("bytes", types::count()), member("largest_chunk", types::count())}};
  return form;
}

const Form& attachment_form() {
  static const Form form{
      "attachment",
      "an attachment",
      {member("name", types::string()), member("media_type", types::string()), member("size", types::count())}};
  return form;
}

const Form& metadata_form() {
  static const Form form{"metadata",
                         "a metadata record",
                         {member("name", types::string()), member("values", types::map(types::string()))}};
  return form;
}

const Form& event_of_file_form() {
  static const Form form{
      "event",
      "an event",
      {member("tick", types::whole(-1, 1e15)), member("time", types::real()), member("severity", types::string()),
       member("source", types::string()), member("text", types::string())}};
  return form;
}

const Form& header_form() {
  static const Form form{
      "header", "the header", {member("profile", types::string()), member("library", types::string())}};
  return form;
}

const Form& info_form() {
  static const Form form =
      with_version({"info",
                    "info --json",
                    {member("file", types::string()),
                     member("form", types::string()),
                     member("size", types::count()),
                     member("header", types::of(header_form)),
                     member("read", types::word({"all", "summary"})),
                     member("begin", types::real()),
                     member("duration", types::real()),
                     member("begin_ns", types::count()),
                     member("end_ns", types::count()),
                     member("ticks", types::count()),
                     member("messages", types::count()),
                     member("schemas", types::array(types::of(schema_of_channel_form))),
                     member("channels", types::array(types::of(channel_of_file_form))),
                     member("statistics", types::nullable(types::of(statistics_form))),
                     member("compression", types::array(types::of(compression_form))),
                     member("attachments", types::array(types::of(attachment_form))),
                     member("metadata", types::array(types::of(metadata_form))),
                     member("event_count", types::count()),
                     member("events", types::nullable(types::array(types::of(event_of_file_form)))),
                     member("damage", findings_type())}});
  return form;
}

const Form& report_form() {
  static const Form form = with_version(
      {"report",
       "report --json",
       {member("file", types::string()), member("link", types::string()), member("verdict", types::string()),
        member("state", types::word({"alone", "equal", "within", "beyond", "failed"})),
        member("first_tick", types::nullable(types::count())), member("begin", types::count()),
        member("end", types::count()), member("bytes", types::count()), member("data_bytes", types::count()),
        member("omitted", strings())}});
  return form;
}

const Form& written_form() {
  static const Form form{
      "written",
      "a written file",
      {member("file", types::string()), member("topic", types::string()), member("rows", types::count()),
       member("columns", types::count()), member("pictures", types::count())}};
  return form;
}

const Form& skipped_form() {
  static const Form form{
      "skipped", "a skipped topic", {member("topic", types::string()), member("why", types::string())}};
  return form;
}

const Form& left_out_form() {
  static const Form form{
      "left_out", "fields that are left out", {member("topic", types::string()), member("fields", types::any())}};
  return form;
}

const Form& export_form() {
  static const Form form =
      with_version({"export",
                    "export --json",
                    {member("written", types::array(types::of(written_form))),
                     member("skipped", types::array(types::of(skipped_form))),
                     member("left_out", types::array(types::of(left_out_form))), member("damage", findings_type())}});
  return form;
}

const Form& export_viewer_form() {
  static const Form form = with_version({"export_viewer", "export --viewer --json", {member("written", strings())}});
  return form;
}

const Form& examined_file_form() {
  static const Form form{
      "examined_file",
      "an examined file",
      {member("file", types::string()), member("readable", types::flag()), member("size", types::count()),
       member("messages", types::count()), member("chunks", types::count()), member("errors", types::count()),
       member("warnings", types::count()), member("notes", types::count())}};
  return form;
}

const Form& file_finding_form() {
  static const Form form{
      "file_finding",
      "a finding in a file",
      {member("file", types::string()), member_if("line", "of metadata.yaml", types::nullable(types::count())),
       member("offset", types::nullable(types::count())), member("inside", types::nullable(types::count())),
       member("severity", types::string()), member("message", types::string())}};
  return form;
}

const Form& doctor_form() {
  static const Form form =
      with_version({"doctor",
                    "doctor --json",
                    {member("errors", types::count()), member("warnings", types::count()),
                     member("notes", types::count()), member("files", types::array(types::of(examined_file_form))),
                     member("findings", types::array(types::of(file_finding_form)))}});
  return form;
}

const Form& lost_form() {
  static const Form form{
      "lost",
      "lost bytes",
      {member("begin", types::count()), member("end", types::count()), member("what", types::string())}};
  return form;
}

const Form& saved_channel_form() {
  static const Form form{"saved_channel",
                         "a channel",
                         {member("id", types::count()), member("topic", types::string()),
                          member("saved", types::count()), member("lost", types::any())}};
  return form;
}

const Form& recover_form() {
  static const Form form = with_version(
      {"recover",
       "recover --json",
       {member("file", types::string()), member("whole", types::flag()), member("messages", types::count()),
        member("attachments", types::count()), member("metadata", types::count()), member("first_time", types::count()),
        member("last_time", types::count()), member("lost_messages", types::count()),
        member("loss_is_known", types::flag()), member("lost_bytes", types::count()),
        member("lost", types::array(types::of(lost_form))), member("remarks", strings()),
        member("channels", types::array(types::of(saved_channel_form)))}});
  return form;
}

const Form& filter_form() {
  static const Form form = with_version(
      {"filter",
       "filter --json",
       {member("file", types::string()), member("messages", types::count()), member("left_out", types::count()),
        member("channels", types::count()), member("attachments", types::count()), member("metadata", types::count()),
        member("first_time", types::count()), member("last_time", types::count()), member("size", types::count()),
        member("remarks", strings())}});
  return form;
}

const Form& merge_form() {
  static const Form form = with_version(
      {"merge",
       "merge --json",
       {member("file", types::string()), member("sources", strings()), member("messages", types::count()),
        member("channels", types::count()), member("attachments", types::count()), member("metadata", types::count()),
        member("size", types::count()), member("remarks", strings())}});
  return form;
}

const Form& rotor_form() {
  static const Form form{"rotor",
                         "the rotor of a joint",
                         {member("inertia", types::real()), member("gear_ratio", types::real()),
                          member("inertia_at_joint", types::real())}};
  return form;
}

const Form& mimic_form() {
  static const Form form{
      "mimic",
      "the joint that a joint follows",
      {member("joint", types::string()), member("multiplier", types::real()), member("offset", types::real())}};
  return form;
}

const Form& limits_form() {
  static const Form form{
      "limits",
      "the limits of a joint",
      {member("lower", types::nullable(types::real())), member("upper", types::nullable(types::real())),
       member("effort", types::nullable(types::real())), member("velocity", types::nullable(types::real()))}};
  return form;
}

const Form& model_joint_form() {
  static const Form form{
      "model_joint",
      "a joint",
      {member("name", types::string()), member("type", types::string()), member("id", types::whole(-1, 1e9)),
       member("parent", types::string()), member("child", types::string()),
       member("axis", types::list(types::real(), 3, 3)), member("limits", types::of(limits_form)),
       member("rotor", types::nullable(types::of(rotor_form))), member("mimic", types::nullable(types::of(mimic_form))),
       member("line", types::whole(-1, 1e9))}};
  return form;
}

const Form& model_link_form() {
  static const Form form{
      "model_link",
      "a link",
      {member("name", types::string()), member("type", types::string()), member("mass", types::real()),
       member("center", types::list(types::real(), 3, 3)), member("inertia", types::list(types::real(), 6, 6)),
       member("position", types::list(types::real(), 3, 3)), member("quaternion", types::list(types::real(), 4, 4)),
       member("parent", maybe_string()), member("line", types::whole(-1, 1e9))}};
  return form;
}

const Form& device_form() {
  static const Form form{
      "device",
      "a device",
      {member("name", types::string()), member("type", types::string()), member("link", types::string()),
       member("id", types::whole(-1, 1e9)), member("line", types::whole(-1, 1e9)),
       member("stated_in", types::word({"model", "scenario"}))}};
  return form;
}

const Form& mesh_form() {
  static const Form form{
      "mesh",
      "a mesh",
      {member("file", types::string()), member("uses", types::count()), member("triangles", types::count())}};
  return form;
}

const Form& triangles_form() {
  static const Form form{
      "triangles", "counts of triangles", {member("visuals", types::count()), member("collisions", types::count())}};
  return form;
}

std::vector<FormKey> model_members() {
  return {member("name", maybe_string()),
          member("links", types::array(types::of(model_link_form))),
          member("joints", types::array(types::of(model_joint_form))),
          member("devices", types::array(types::of(device_form))),
          member("meshes", types::array(types::of(mesh_form))),
          member("triangles", types::of(triangles_form)),
          member("mass", types::nullable(types::real())),
          member("findings", findings_type())};
}

const Form& model_form() {
  static const Form form{"model", "a model", model_members()};
  return form;
}

const Form& inspect_form() {
  static const Form form = with_version({"inspect", "inspect --json", model_members()});
  return form;
}

const Form& inspected_body_form() {
  static const Form form{
      "inspected_body", "a body", {member("body", types::string()), member("model", types::of(model_form))}};
  return form;
}

const Form& inspect_scenario_form() {
  static const Form form = with_version(
      {"inspect_scenario",
       "inspect --scenario --json",
       {member("bodies", types::array(types::of(inspected_body_form))), member("findings", findings_type())}});
  return form;
}

const Form& import_item_form() {
  static const Form form{
      "import_item",
      "an item of a project",
      {member("class", types::string()), member("name", types::string()), member("line", types::whole(-1, 1e9)),
       member("taken", types::flag()), member("outcome", types::string())}};
  return form;
}

const Form& import_form() {
  static const Form form =
      with_version({"import",
                    "import --json",
                    {member("scenario", types::string()), member("items", types::array(types::of(import_item_form))),
                     member("remarks", findings_type())}});
  return form;
}

}  // namespace

std::vector<NamedForm> file_objects() {
  return {object_of("info", "info --json", {info_form}),
          object_of("report", "report --json", {report_form}),
          object_of("export", "export --json", {export_form, export_viewer_form}),
          object_of("doctor", "doctor --json", {doctor_form}),
          object_of("recover", "recover --json", {recover_form}),
          object_of("filter", "filter --json", {filter_form}),
          object_of("merge", "merge --json", {merge_form}),
          object_of("inspect", "inspect --json", {inspect_form, inspect_scenario_form}),
          object_of("import", "import --json", {import_form})};
}

}  // namespace rehearse::tool
