// Lets a quadruped trot by a network of two layers, which fixtures/policy/train_trot.py has taught.
//
// fixtures/policy/trot.yaml states the observation: the names, their order and scales, the joints' order and default
// pose. fixtures/policy/trot_policy.py is the same controller in Python, with the same bits: both add in the same
// order, and neither uses a function whose last bits depend on the processor, apart from sin and cos of the C library.
//
// Option: the file of the policy, relative to the share folder.

#include <rehearse_variable.h>

#include <Eigen/Core>
#include <cmath>
#include <cnoid/ExecutablePath>
#include <cnoid/Imu>
#include <cnoid/SimpleController>
#include <cnoid/YAMLReader>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
constexpr double pi = 3.14159265358979323846;

/// weights * (x, 1), column after column: the order of a sum decides its last bits.
VectorXd affine(const MatrixXd& weights, const VectorXd& x) {
  VectorXd y = weights.col(x.size());
  // each product is rounded before it is added
  for (int column = 0; column < x.size(); ++column) y += (weights.col(column) * x[column]).eval();
  return y;
}

class TrotPolicyController : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    const auto file = cnoid::shareDirPath() / io->optionString();
    cnoid::YAMLReader reader;
    if (!reader.load(file.string())) {
      io->os() << reader.errorMessage() << "\n";
      return false;
    }
    try {
      return read(*reader.document()->toMapping(), file.parent_path(), io);
    } catch (const cnoid::ValueNode::Exception& wrong) {
      io->os() << file.filename().string() << ":" << wrong.line() << ": " << wrong.message() << "\n";
      return false;
    }
  }

  bool control() override {
    if (tick_++ % ticks_per_action_ == 0) act();
    for (int i = 0; i < last_action_.size(); ++i) {
      cnoid::Link* joint = joints_[i];
      const double target = default_pose_[i] + action_scale_ * last_action_[i];
      joint->u() = p_ * (target - joint->q()) - d_ * joint->dq();
    }
    return true;
  }

 private:
  struct Term {
    std::string name;
    double scale;
  };

  bool read(const cnoid::Mapping& table, const std::filesystem::path& folder, cnoid::SimpleControllerIO* io) {
    gait_period_ = table["gait_period"].toDouble();
    step_ = table["step"].toDouble();
    ticks_per_action_ = static_cast<int>(std::lround(step_ / io->timeStep()));
    p_ = table["gains"].toMapping()->get("p").toDouble();
    d_ = table["gains"].toMapping()->get("d").toDouble();
    action_scale_ = table["action_scale"].toDouble();
    for (const cnoid::ValueNodePtr& node : *table["observation"].toListing()) {
      const cnoid::Mapping& term = *node->toMapping();
      terms_.push_back({term["name"].toString(), term["scale"].toDouble()});
    }
    const cnoid::Listing& joints = *table["joints"].toListing();
    default_pose_.resize(joints.size());
    last_action_.setZero(joints.size());
    for (int i = 0; i < joints.size(); ++i) {
      const cnoid::Mapping& stated = *joints[i].toMapping();
      default_pose_[i] = stated["default"].toDouble();
      names_.push_back(stated["name"].toString());
      cnoid::Link* joint = io->body()->joint(names_[i]);
      if (!joint) {
        io->os() << io->body()->modelName() << " has no joint " << names_[i] << "\n";
        return false;
      }
      joint->setActuationMode(JointTorque);
      io->enableInput(joint, JointAngle | JointVelocity);
      io->enableOutput(joint);
      joints_.push_back(joint);
    }
    imu_ = io->body()->findDevice<cnoid::Imu>("Imu");
    if (!imu_) {
      io->os() << io->body()->modelName() << " has no Imu\n";
      return false;
    }
    io->enableInput(imu_);
    return read_weights(folder / table["weights"].toString(), io);
  }

  bool read_weights(const std::filesystem::path& file, cnoid::SimpleControllerIO* io) {
    std::ifstream in(file);
    for (MatrixXd* weights : {&first_, &second_}) {
      int rows = 0, columns = 0;
      in >> rows >> columns;
      if (in) weights->resize(rows, columns);
      for (int row = 0; in && row < rows; ++row)
        for (int column = 0; column < columns; ++column) in >> (*weights)(row, column);
    }
    const int inputs = static_cast<int>(observation().size());
    if (in && first_.cols() == inputs + 1 && second_.cols() == first_.rows() + 1 &&
        second_.rows() == last_action_.size())
      return true;
    io->os() << file.filename().string() << " isn't two layers from " << inputs << " numbers to " << joints_.size()
             << "\n";
    return false;
  }

  /// The numbers that the network sees, with their names, in the order of the table.
  std::vector<std::pair<std::string, double>> observation() const {
    std::vector<std::pair<std::string, double>> numbers;
    for (const Term& term : terms_) {
      const auto add = [&](const std::string& part, double value) {
        numbers.emplace_back("observation." + term.name + "." + part, term.scale * value);
      };
      const double phase = 2.0 * pi * (actions_ * step_ / gait_period_);
      if (term.name == "clock") {
        add("sin", std::sin(phase));
        add("cos", std::cos(phase));
      } else if (term.name == "angular_velocity") {
        for (int axis = 0; axis < 3; ++axis) add(std::string(1, "xyz"[axis]), imu_->w()[axis]);
      }
      for (int i = 0; i < last_action_.size(); ++i) {
        if (term.name == "q") add(names_[i], joints_[i]->q() - default_pose_[i]);
        if (term.name == "dq") add(names_[i], joints_[i]->dq());
        if (term.name == "last_action") add(names_[i], last_action_[i]);
      }
    }
    return numbers;
  }

  void act() {
    const auto observed = observation();
    VectorXd input(observed.size());
    for (int i = 0; i < input.size(); ++i) {
      input[i] = observed[i].second;
      rehearse_variable(observed[i].first.c_str(), input[i]);
    }
    last_action_ = affine(second_, affine(first_, input).cwiseMax(0.0));
    for (int i = 0; i < last_action_.size(); ++i) rehearse_variable(("action." + names_[i]).c_str(), last_action_[i]);
    ++actions_;
  }

  std::vector<std::string> names_;  // of the joints, in the order of the table
  std::vector<cnoid::Link*> joints_;
  cnoid::Imu* imu_ = nullptr;
  std::vector<Term> terms_;
  MatrixXd first_, second_;                // the last column of each is added
  VectorXd default_pose_;                  // [rad]
  VectorXd last_action_;                   // of each joint
  double action_scale_ = 0.0;              // [rad]
  double p_ = 0.0, d_ = 0.0;               // [N·m/rad], [N·m·s/rad]
  double step_ = 0.0, gait_period_ = 0.0;  // [s]
  int ticks_per_action_ = 1;
  int tick_ = 0, actions_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(TrotPolicyController)
