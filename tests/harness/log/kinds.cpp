#include "kinds.h"

#include <limits>
#include <numbers>

#include "../bag/bag_files.h"

namespace rehearse::kinds {
namespace {

/// std_msgs/msg/Float32MultiArray without its layout.
struct SingleEfforts {
  static constexpr std::string_view type_name = "std_msgs/msg/Float32MultiArray";
  std::vector<float> data;
  REHEARSE_FIELDS(data)
};

/// std_msgs/msg/Float64MultiArray without its layout.
struct Numbers {
  static constexpr std::string_view type_name = "std_msgs/msg/Float64MultiArray";
  std::vector<double> data;
  REHEARSE_FIELDS(data)
};

/// The displacement of a joint, and its velocity.
std::pair<double, double> motion(std::size_t joint, std::int64_t time, Chance& noise) {
  const double t = static_cast<double>(time - start) * 1e-9, phase = 0.7 * static_cast<double>(joint);
  double q = 0.0, dq = 0.0;
  for (const auto& [amplitude, hertz] : {std::pair(0.3, 1.3), std::pair(0.1, 4.1)}) {
    const double w = 2.0 * std::numbers::pi * hertz;
    q += amplitude * std::sin(w * t + phase);
    dq += amplitude * w * std::cos(w * t + phase);
  }
  return {q + noise.between(-1e-4, 1e-4), dq + noise.between(-1e-2, 1e-2)};
}

Logged message_at(const std::string& topic, std::int64_t time) {
  Logged message;
  message.topic = topic;
  message.written = message.logged = message.stamp = time;
  return message;
}

void change_commands(std::vector<Logged>& commands, Change change) {
  if (change == Change::swapped)
    for (Logged& command : commands) std::ranges::reverse(command.joints.effort);
  for (std::size_t i = commands.size(); i-- > 0;)
    for (std::size_t j = 0; j < commands[i].joints.effort.size(); ++j) {
      double& effort = commands[i].joints.effort[j];
      if (change == Change::gain) effort *= 1.01;
      if (change == Change::sign) effort = -effort;
      if (change == Change::late && i > 0) effort = commands[i - 1].joints.effort[j];
    }
}

std::vector<std::byte> payload_of(const Logged& message) {
  CdrWriter cdr;
  if (message.is_single) {
    SingleEfforts efforts;
    efforts.data.assign(message.joints.effort.begin(), message.joints.effort.end());
    msg::encode(efforts, cdr);
  } else if (message.is_array) {
    msg::encode(Numbers{message.joints.effort}, cdr);
  } else {
    msg::JointState joints = message.joints;
    joints.header.stamp = msg::Time::from_ns(static_cast<std::uint64_t>(message.stamp));
    msg::encode(joints, cdr);
  }
  std::vector<std::byte> bytes(cdr.bytes().begin(), cdr.bytes().end());
  if (message.is_cut) bytes.resize(bytes.size() - 20);
  return bytes;
}

void write_file(const std::vector<const Logged*>& messages, const fs::path& file, const mcap::WriterOptions& options) {
  const auto writer = mcap::Writer::create(file, options);
  ASSERT_TRUE(writer.ok());
  std::map<std::string, std::uint16_t> channels;
  for (const Logged* message : messages) {
    if (channels.count(message->topic) == 0) {
      const auto schema = message->is_array    ? (*writer)->add_schema(std::string(Numbers::type_name), "ros2msg",
                                                                       msg::schema_text<Numbers>())
                          : message->is_single ? (*writer)->add_schema(std::string(SingleEfforts::type_name), "ros2msg",
                                                                       msg::schema_text<SingleEfforts>())
                                               : (*writer)->add_schema(std::string(msg::JointState::type_name),
                                                                       "ros2msg", msg::schema_text<msg::JointState>());
      channels[message->topic] = (*writer)->add_channel(schema, message->topic, "cdr");
    }
    const auto time = static_cast<std::uint64_t>(message->logged);
    ASSERT_TRUE((*writer)->write(channels[message->topic], time, time, payload_of(*message)));
  }
  ASSERT_TRUE((*writer)->close());
}

}  // namespace

Plan::Plan(Chance& numbers) : chance(numbers) {
  for (int i = 0; i < ticks; ++i) times.push_back(start + i * period);
}

std::string_view name_of(Change change) {
  constexpr std::string_view names[] = {"same", "gain", "sign", "swapped", "late"};
  return names[static_cast<std::size_t>(change)];
}

Log run(const Plan& plan, const std::string& controller, Change change) {
  Log log{plan.chance, {}, {}, {}, {}};
  const fs::path model = fs::path(FIXTURES_DIR) / "models/pan_tilt_head.urdf";
  std::unique_ptr<ControllerBench> bench;
  for (std::size_t i = 0; i < plan.times.size(); ++i) {
    const std::int64_t time = plan.times[i];
    Logged state = message_at("/joint_states", time), of_tilt = message_at("/tilt_states", time - period / 4);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const auto [q, dq] = motion(j, time, plan.chance);
      Logged& message = j == 1 && plan.tilt_every > 0 ? of_tilt : state;
      message.joints.name.push_back(joints[j]);
      const bool is_nan = plan.nan_at > 0 && i == plan.nan_at && joints[j] == "TILT";
      message.joints.position.push_back(is_nan ? std::numeric_limits<double>::quiet_NaN() : q + plan.turns);
      message.joints.velocity.push_back(dq);
    }
    if (plan.tilt_every > 0 && i % plan.tilt_every == 0) log.others.push_back(of_tilt);
    log.states.push_back(state);
    if (i < plan.first_command) continue;
    if (!bench || std::ranges::find(plan.restarts, i) != plan.restarts.end()) {
      BenchOptions options;
      options.time_step = static_cast<double>(period) * 1e-9;
      options.options = plan.options;
      for (std::size_t j = 0; j < state.joints.name.size(); ++j)
        options.joints[state.joints.name[j]] = state.joints.position[j];
      bench = std::make_unique<ControllerBench>(controller, model.string(), options);
    }
    for (const Logged* message : {static_cast<const Logged*>(log.others.empty() ? nullptr : &log.others.back()),
                                  static_cast<const Logged*>(&state)})
      for (std::size_t j = 0; message && j < message->joints.name.size(); ++j) {
        bench->joint(message->joints.name[j]).q = message->joints.position[j];
        bench->joint(message->joints.name[j]).dq = message->joints.velocity[j];
      }
    EXPECT_TRUE(bench->tick());
    Logged& command = log.commands.emplace_back(message_at("/joint_commands", time + latency));
    command.joints.name = joints;
    for (const std::string& joint : joints) command.joints.effort.push_back(bench->joint(joint).u);
    if (!plan.publishes_state) continue;
    Logged& published = log.controller_states.emplace_back(message_at("/state", time + latency));
    published.is_array = true;
    for (const std::string& joint : joints)
      for (const char* number : {"/last", "/state"}) published.joints.effort.push_back(bench->variable(joint + number));
  }
  change_commands(log.commands, change);
  return log;
}

fs::path write(const Log& log, const fs::path& folder) {
  std::vector<const Logged*> messages;
  for (const std::vector<Logged>* part : {&log.states, &log.commands, &log.controller_states, &log.others})
    for (const Logged& message : *part)
      if (message.is_kept) messages.push_back(&message);
  std::ranges::stable_sort(messages, [](const Logged* a, const Logged* b) { return a->written < b->written; });
  mcap::WriterOptions options;
  options.chunk_size = 64 * 1024;
  if (log.container == Container::zstd) options.compression = mcap::Compression::zstd;
  if (log.container == Container::lz4) options.compression = mcap::Compression::lz4;
  const fs::path file = folder / "log.mcap";
  if (log.container == Container::split) {
    const fs::path bag = folder / "log";
    fs::create_directories(bag);
    const auto half = messages.begin() + static_cast<std::ptrdiff_t>(messages.size() / 2);
    write_file({messages.begin(), half}, bag / "log_0.mcap", options);
    write_file({half, messages.end()}, bag / "log_1.mcap", options);
    test::write_metadata(bag, {"mcap", {"log_0.mcap", "log_1.mcap"}, messages.size()});
    return bag;
  }
  write_file(messages, file, options);
  if (log.container == Container::unfinished) fs::resize_file(file, fs::file_size(file) * 4 / 5);
  if (log.container != Container::zstd_file) return file;
  const fs::path compressed = folder / "log.mcap.zstd";
  test::write_bytes(compressed, test::compressed(test::read_bytes(file)));
  return compressed;
}

}  // namespace rehearse::kinds
